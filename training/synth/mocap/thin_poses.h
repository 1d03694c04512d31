#pragma once

#include <span>
#include <vector>

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Makes the greedy choice of section 4.1.2: goes through the poses in order and keeps each pose that differs from
/// every pose kept so far by at least `min_angle_rad` in some joint (`largest_angle`). Returns the indices of the kept
/// poses in rising order. An angle of 0 keeps all. The result is exact; a tree over joint directions makes the search
/// fast. Throws Error for an angle that is negative or not finite, and for a pose with a number that is not finite.
std::vector<int> thin_poses(std::span<const Pose> poses, float min_angle_rad);

}  // namespace vesalius::synth
