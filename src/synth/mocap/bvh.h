#pragma once

#include <string>
#include <string_view>

#include "synth/mocap/motion.h"

namespace vesalius::synth {

/// Parses a BVH file (Biovision hierarchy): channels in any order, 0 to 6 a joint, angles in degrees; positions of
/// joints other than the root are read past. A bone points to the joint's first child that lies apart from it.
/// `name` stands for the file in errors. Throws Error naming line and expectation for text that is no such file, a
/// line of motion with too few or too many numbers, a number that is not finite, more than kMaxMotionJoints joints.
Motion parse_bvh(std::string_view text, const std::string& name);

}  // namespace vesalius::synth
