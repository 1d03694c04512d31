#include <cstddef>
#include <cstdint>
#include <string_view>

#include "vesalius/error.h"
#include "vesalius/image_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    vesalius::decode_depth_png(bytes, "fuzz.png");
  } catch (const vesalius::Error&) {
  }
  try {
    vesalius::decode_colour(bytes, "fuzz.png");
  } catch (const vesalius::Error&) {
  }
  return 0;
}
