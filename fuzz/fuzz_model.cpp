#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

#include "io/files/packed.h"
#include "io/model/model_file.h"
#include "io/model/model_trees.h"
#include "vesalius/base/error.h"

namespace {

/// Corrects size and checksum. A fuzzer cannot guess them and would not get past the header.
std::string with_fitting_header(std::string bytes) {
  if (bytes.size() < 28) return bytes;
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 12, &size, sizeof size);
  const std::string hashed = bytes.substr(0, 20) + bytes.substr(28);
  const std::uint64_t sum = XXH64(hashed.data(), hashed.size(), 0);
  std::memcpy(bytes.data() + 20, &sum, sizeof sum);
  return bytes;
}

/// Returns a tree whose sizes and columns come from the input. The columns are compressed here because a fuzzer cannot
/// guess a zstd frame either.
std::string packed_tree(std::string_view input) {
  vesalius::ByteWriter out, columns;
  const auto byte = [&] {
    const std::uint8_t value = input.empty() ? 0 : static_cast<std::uint8_t>(input.front());
    input.remove_prefix(std::min<std::size_t>(1, input.size()));
    return value;
  };
  out.number(std::uint32_t{1});
  out.number(std::uint32_t{byte()});
  out.number(std::uint32_t{byte()});
  while (!input.empty()) {
    const std::size_t asked = byte();
    const std::size_t size = std::min(asked, input.size());
    columns.bytes() += vesalius::pack(input.substr(0, size), 1);
    input.remove_prefix(size);
  }
  out.text(columns.bytes());
  return out.bytes();
}

void read_and_write_trees(const std::string& bytes) {
  const std::string name = "fuzz";
  vesalius::ByteReader in(bytes, name);
  vesalius::Forest forest;
  forest.body = vesalius::paper_body();
  forest.trees = vesalius::read_trees(in);
  check(forest);
  vesalius::serialise_model(forest);
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
  try {
    read_and_write_trees(packed_tree(bytes));
  } catch (const vesalius::Error&) {
  }
  return 0;
}
