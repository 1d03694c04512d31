#include <cstddef>
#include <cstdint>
#include <string_view>

#include "synth/mocap/motion.h"
#include "synth/mocap/retarget.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto motion = vesalius::synth::parse_bvh({reinterpret_cast<const char*>(data), size}, "fuzz.bvh");
    vesalius::synth::retarget(motion, vesalius::synth::find_convention(motion, vesalius::synth::builtin_conventions()));
  } catch (const vesalius::Error&) {
  }
  return 0;
}
