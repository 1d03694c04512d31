#include "cli/satellites.h"

namespace vesalius::cli {

// CMake writes satellites.inc, which names the satellites of this build.
#define VESALIUS_SATELLITE(name) Satellite name##_satellite();
#include "satellites.inc"
#undef VESALIUS_SATELLITE

std::vector<Satellite> satellites() {
  return {
#define VESALIUS_SATELLITE(name) name##_satellite(),
#include "satellites.inc"
#undef VESALIUS_SATELLITE
  };
}

std::vector<std::string> satellite_names() {
  return {"view", "ros2", "cluster", "synth", "train", "evaluate", "assets", "cuda"};
}

}  // namespace vesalius::cli
