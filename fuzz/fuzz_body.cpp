#include <cstddef>
#include <cstdint>

#include "vesalius/body_model.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    vesalius::parse_body_model({reinterpret_cast<const char*>(data), size}, "fuzz");
  } catch (const vesalius::Error&) {
  }
  return 0;
}
