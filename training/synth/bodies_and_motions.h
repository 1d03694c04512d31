#pragma once

#include <memory>
#include <vector>

#include "synth/body/makehuman.h"
#include "synth/mocap/motion_library.h"
#include "synth/pose/pose_sampler.h"

namespace vesalius::synth {

/// Data from files. All of it is optional.
struct BodiesAndMotions {
  std::shared_ptr<const MakeHumanModel> makehuman;
  std::vector<SampledPose> captured;  ///< poses from motion capture
  MovementLibrary movements;          ///< movements from motion capture, which only clips use
};

}  // namespace vesalius::synth
