#pragma once

#include <string>
#include <string_view>

#include "synth/mocap/motion.h"

namespace vesalius::synth {

/// Parses a BVH file (Biovision hierarchy) with 0 to 6 channels for each joint in any order and angles in degrees.
/// Positions of joints other than the root are ignored. A bone points to the joint's first child that is not at the
/// joint itself. `name` is used as the path in errors. Throws Error naming line and expectation if the text is not a
/// BVH file, a line of motion has too few or too many numbers, a number is not finite, or there are more than
/// kMaxMotionJoints joints.
Motion parse_bvh(std::string_view text, const std::string& name);

}  // namespace vesalius::synth
