#pragma once

#include <string>
#include <string_view>

#include "synth/mocap/asf.h"
#include "synth/mocap/motion.h"

namespace vesalius::synth {

/// Parses an AMC file, which holds motion of a skeleton. A bone's rotation is C M C^-1, where C comes from its axis and
/// M is the product of its dofs; values that a frame leaves out are 0. AMC files do not state their frame rate, so
/// `fps` gives it. Throws Error naming line and expectation, also for a bone that the skeleton lacks.
Motion parse_amc(std::string_view text, const std::string& name, const AsfSkeleton& skeleton, float fps);

}  // namespace vesalius::synth
