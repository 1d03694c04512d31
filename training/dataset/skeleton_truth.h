#pragma once

#include <string>
#include <vector>

#include "metrics/frame_truth.h"

namespace vesalius {

/// Adds to `truth` what follows from the joints of the people's skeletons (synth/body/poser.h): the joints of
/// other trackers under their names, each a joint of the skeleton or the middle between two, and the people's statures.
/// `names` names the skeletons' joints, `skeletons` is [person][joint] in metres, optical frame. Adds nothing if the
/// names are those of another skeleton or there is none.
void add_skeleton_truth(const std::vector<std::string>& names,
                        const std::vector<std::vector<Eigen::Vector3f>>& skeletons, FrameTruth& truth);

}  // namespace vesalius
