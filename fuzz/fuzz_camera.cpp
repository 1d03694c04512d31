#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "io/sources/camera_file.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    auto facts = vesalius::parse_camera({reinterpret_cast<const char*>(data), size}, "camera");
    std::vector<std::string> notes;
    vesalius::resolve_camera(facts, 640, 480, true, "fuzz", notes);
  } catch (const vesalius::Error&) {
  }
  return 0;
}
