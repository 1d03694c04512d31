#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dataset/truth_source.h"
#include "vesalius/body_model.h"
#include "vesalius/frame_source.h"

namespace vesalius {

/// Opens frames with their truth: a labelled dataset, a folder of labelled frames (LabelledExporter), or any other
/// source that `open_source` opens and TruthFolder has truth for. Gives the first of every `step` frames. Throws Error
/// as those readers do.
std::unique_ptr<TruthSource> open_truth(const std::string& uri, int step = 1, const SourceOptions& options = {});

/// Converts a labelled frame to truth. `joint_names` names its skeletons' joints (skeleton_truth.h). `clip` is the
/// number of the clip to which the frame belongs, or -1; person i is then the same in all its frames, and people who
/// are out of the picture are in the lists but do not count as in view.
TrueFrame as_true_frame(LabelledFrame labelled, const std::vector<std::string>& joint_names = {}, int clip = -1);

/// Returns the names of a body's parts, in order.
std::vector<std::string> part_names_of(const BodyModel& body);

}  // namespace vesalius
