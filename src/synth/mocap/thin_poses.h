#pragma once

#include <span>
#include <vector>

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// The greedy choice of section 4.1.2: goes through the poses in order and keeps each that differs from every pose
/// kept so far by at least `min_angle_rad` in some joint (`largest_angle`). Returns the indices of those kept, rising.
/// An angle of 0 keeps all. Exact; the poses kept are found by a tree over joint directions, not one by one.
/// Throws Error for an angle that is negative or not finite, or a pose with a number that is not finite.
std::vector<int> thin_poses(std::span<const Pose> poses, float min_angle_rad);

}  // namespace vesalius::synth
