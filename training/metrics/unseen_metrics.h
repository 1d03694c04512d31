#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/joint_metrics.h"
#include "metrics/metric_table.h"
#include "vesalius/person.h"

namespace vesalius {

/// A joint of a true person.
struct TrueJoint {
  Eigen::Vector3f at;      ///< metres, optical frame
  std::vector<int> parts;  ///< those that it is derived from, about which it lies
};

/// Why the camera does not see a true joint.
struct TrueReason {
  Unseen unseen = Unseen::not_sure;
  int behind = -1;  ///< index of the true person who hides it, where unseen is behind_person; otherwise -1
};

/// Returns this of a joint of a true person: from the frame's depth, and the true person and part of its pixels, about
/// the true place. What hides a joint is nearer by 5 cm at least, of the person's own body by 15 cm and another part
/// than its own. If nothing does the reason is not_sure: the joint is there to be seen.
TrueReason true_reason(const TrueFrame& frame, std::size_t person, const TrueJoint& joint);

/// Returns whether the reasons are right that are given for the joints of a true person that are not observed, also by
/// the joints' confidence, and how often each is given for each true one. `joints` are the found person's in the order
/// of `set`, `truth` the true ones under `names`; those that are not known (NaN) do not count. `found` has the index of
/// the found person for each true one, -1 for those who were missed: where somebody hides a joint, it must be the right
/// one. Frames whose persons are not known apart have no such terms.
MetricTerms unseen_terms(const TrueFrame& frame, std::size_t person, const std::vector<std::string>& names,
                         const std::vector<Eigen::Vector3f>& truth, const JointSet& set,
                         const std::vector<Joint>& joints, const std::vector<int>& found);

}  // namespace vesalius
