#include <cstddef>
#include <cstdint>
#include <string_view>

#include "io/sources/pcd.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto grid = vesalius::parse_pcd({reinterpret_cast<const char*>(data), size}, "fuzz.pcd");
    vesalius::depth_of(grid);
    vesalius::estimate_camera(grid, "fuzz.pcd");
  } catch (const vesalius::Error&) {
  }
  return 0;
}
