#include <cstddef>
#include <cstdint>
#include <string_view>

#include "io/files/depth_picture.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    vesalius::to_millimetres(vesalius::decode_depth(bytes, "fuzz.png"), 5000.F, false);
  } catch (const vesalius::Error&) {
  }
  try {
    vesalius::decode_colour(bytes, "fuzz.png");
  } catch (const vesalius::Error&) {
  }
  return 0;
}
