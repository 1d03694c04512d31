#pragma once

#include <string>
#include <string_view>

#include "synth/mocap/asf.h"
#include "synth/mocap/motion.h"

namespace vesalius::synth {

/// Parses an AMC file, the motion of that skeleton: a bone's rotation is C M C^-1 with C from its axis and M the
/// product of its dofs; what a frame leaves out is 0. AMC files do not say how fast they play: `fps` does.
/// Throws Error naming line and expectation, also for a bone that the skeleton lacks.
Motion parse_amc(std::string_view text, const std::string& name, const AsfSkeleton& skeleton, float fps);

}  // namespace vesalius::synth
