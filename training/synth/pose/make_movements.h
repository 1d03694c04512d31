#pragma once

#include <span>

#include "synth/pose/movement.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// A pose, and when a movement has it.
struct KeyPose {
  Pose pose;
  float at_s = 0.F;
  bool falling = false;   ///< whether the movement to it gets faster and faster; otherwise it begins and ends gently
  bool feet_stay = true;  ///< whether the ankles keep their place on the way to it; otherwise the pelvis does
};

/// Returns the share of a way that is done after a share of its time.
float eased(float share, bool falling);

/// Returns a movement through poses, at 30 states a second from the first one's time on. Joints turn the shorter way.
/// Where feet stay, the middle of the ankles does, and the pelvis goes over the floor by as much as the legs take it.
/// There must be at least two poses, in the order of their times.
Movement move_through(std::span<const KeyPose> keys);

/// Returns the movement of somebody who stands and falls down to a lying pose within about a second: knees give way,
/// then the body tips over.
Movement fall_down(const Pose& standing, const Pose& lying, Random& random);

/// Returns the movement of somebody who stands before a seat and sits down on it in 1 to 2 seconds, the trunk bent
/// forwards meanwhile, and then takes the legs to where the sitting pose has them.
Movement sit_down(const Pose& standing, const Pose& sitting, Random& random);

/// Returns a movement of somebody who stays as in `base` and now and then takes arms and head to where another of the
/// poses has them, within human speed: 30 states a second. Other poses with which the body would intersect itself are
/// left out; without any left the person keeps still.
Movement fidget(const Pose& base, std::span<const Pose> others, float seconds, Random& random);

}  // namespace vesalius::synth
