#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "io/model_file.h"
#include "vesalius/error.h"

namespace {

/// Makes size and checksum fit: a fuzzer cannot guess them and would stop at the header.
std::string with_fitting_header(std::string bytes) {
  if (bytes.size() < 28) return bytes;
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 12, &size, sizeof size);
  const std::string hashed = bytes.substr(0, 20) + bytes.substr(28);
  const std::uint64_t sum = XXH64(hashed.data(), hashed.size(), 0);
  std::memcpy(bytes.data() + 20, &sum, sizeof sum);
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  for (const std::string& file : {bytes, with_fitting_header(bytes)}) {
    try {
      vesalius::serialise_model(vesalius::parse_model(file, "fuzz"));
    } catch (const vesalius::Error&) {
    }
  }
  return 0;
}
