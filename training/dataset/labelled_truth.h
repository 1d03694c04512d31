#pragma once

#include <string>
#include <vector>

#include "metrics/frame_truth.h"
#include "vesalius/body_model.h"

namespace vesalius {

/// Converts a labelled frame to truth. `joint_names` names the joints of its skeletons (synth/body/poser.h), from
/// which the joints of other trackers and the people's statures follow; those of another skeleton give none. `clip` is
/// the number of the clip to which the frame belongs, or -1; person i is then the same in all its frames, and people
/// who are out of the picture are in the lists but do not count as in view.
TrueFrame as_true_frame(LabelledFrame labelled, const std::vector<std::string>& joint_names = {}, int clip = -1);

/// Returns the names of a body's parts, in order.
std::vector<std::string> part_names_of(const BodyModel& body);

}  // namespace vesalius
