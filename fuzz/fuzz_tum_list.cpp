#include <cstddef>
#include <cstdint>
#include <string_view>

#include "io/sources/acceleration_file.h"
#include "io/sources/list_source.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    vesalius::parse_accelerations(text, "imu.csv");
  } catch (const vesalius::Error&) {
  }
  try {
    const std::size_t half = size / 2;
    vesalius::associate(vesalius::parse_tum_list(text.substr(0, half), "depth.txt"),
                        vesalius::parse_tum_list(text.substr(half), "rgb.txt"), 0.02);
  } catch (const vesalius::Error&) {
  }
  return 0;
}
