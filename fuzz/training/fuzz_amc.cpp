#include <cstddef>
#include <cstdint>
#include <string_view>

#include "synth/mocap/motion.h"
#include "synth/mocap/retarget.h"
#include "vesalius/error.h"

/// The input is a skeleton, a byte 0, and a motion of the skeleton.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view both(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = both.find('\0');
  if (cut == std::string_view::npos) return 0;
  try {
    const auto skeleton = vesalius::synth::parse_asf(both.substr(0, cut), "fuzz.asf");
    const auto motion = vesalius::synth::parse_amc(both.substr(cut + 1), "fuzz.amc", skeleton, 120.F);
    vesalius::synth::retarget(motion, vesalius::synth::find_convention(motion, vesalius::synth::builtin_conventions()));
  } catch (const vesalius::Error&) {
  }
  return 0;
}
