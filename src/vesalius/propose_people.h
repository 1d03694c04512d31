#pragma once

#include <vector>

#include "vesalius/appearance.h"
#include "vesalius/body_model.h"
#include "vesalius/find_clusters.h"
#include "vesalius/frame.h"
#include "vesalius/group_votes.h"
#include "vesalius/image.h"
#include "vesalius/label_scene.h"
#include "vesalius/people_options.h"
#include "vesalius/person.h"
#include "vesalius/trace.h"

namespace vesalius {

/// The result of the first pass on a frame.
struct Scene {
  SceneLabels labels;
  LabelImage proposals;         ///< labels with the proposals' weight of the background
  Clusters clusters;            ///< of the proposals
  std::vector<Skeleton> rough;  ///< best first
  VoteGroups groups;            ///< none where the labeller knows of no votes
};

/// Returns candidates with their rough skeletons and grown masks (section 7). Groups of votes come first: each has the
/// best skeleton inside it, or one without parts, and no pixel of another group. Rough skeletons follow that lie mostly
/// outside of all groups.
std::vector<Trace::Candidate> propose_people(const Frame& frame, const Scene& scene, const Looks& looks,
                                             const BodyModel& body, const DetectOptions& options);

}  // namespace vesalius
