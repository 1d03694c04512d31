#pragma once

#include <cstdlib>
#include <string>

namespace vesalius {

/// Flags of `vesalius synth` for small frames with few built-in bodies.
inline constexpr const char* kSmallFrames =
    " --sensor.width 96 --sensor.height 72 --body.kind builtin --body.count 4 --pose.captured 0";

/// More flags for frames from which a forest learns quickly: one upright person who faces the camera in full view.
inline constexpr const char* kEasyFrames =
    " --people.none 0 --people.one 1 --people.two 0 --people.three 0 --people.four 0 --scene.frontal-share 1"
    " --scene.frontal-range 20 --scene.furniture-max 0 --scene.mannequin-share 0 --scene.occluder-probability 0"
    " --scene.min-visible 0.9 --pose.sampler.sitting 0 --pose.sampler.lying 0 --pose.sampler.floor-sitting 0"
    " --pose.sampler.bending 0 --pose.sampler.any 0 --pose.sampler.kneeling 0 --pose.sampler.squatting 0";

/// More flags for rooms without people.
inline constexpr const char* kEmptyFrames =
    " --people.none 1 --people.one 0 --people.two 0 --people.three 0 --people.four 0";

/// Returns B of the last "accuracy A (B among parts)" in the output of `vesalius train`, or -1 if there is none.
inline double accuracy_in(const std::string& text) {
  const std::size_t at = text.rfind("accuracy ");
  const std::size_t open = at == std::string::npos ? at : text.find('(', at);
  return open == std::string::npos ? -1.0 : std::strtod(text.c_str() + open + 1, nullptr);
}

}  // namespace vesalius
