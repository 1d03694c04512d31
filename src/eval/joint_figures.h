#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "eval/figure_table.h"
#include "vesalius/derive_joints.h"

namespace vesalius {

/// Distance up to which a joint counts as right, metres (the ITOP tables call the share of right joints mAP).
inline constexpr double kJointTolerance_m = 0.1;
/// Of how many centimetres the curve of the joint score goes up to.
inline constexpr int kJointCurve_cm = 30;

/// Joints of one true person under the names of its data set, and where they were found; NaN = not known or not found.
struct JointPair {
  std::vector<Eigen::Vector3f> truth;
  std::vector<Eigen::Vector3f> found;  ///< of the same length
};

/// Where joints of a set lie in `joints` (in the order of `set`), in the order of `names`; NaN for those not found, and
/// all NaN for a person who was not found (`joints` empty). Throws Error for a name that the set lacks.
std::vector<Eigen::Vector3f> joints_by_name(const std::vector<std::string>& names, const JointSet& set,
                                            const std::vector<Joint>& joints);

/// The set called `wanted` if it has all of these joints, else the first one that does; null for none.
const JointSet* find_joint_set(const BodyModel& body, const std::vector<std::string>& names,
                               std::string_view wanted = "");

/// Distance of each joint, metres; NaN where the truth is not known; infinity for joints not found.
std::vector<double> joint_errors(const JointPair& pair);

/// Mean distance of the joints that both have, metres: as they are; with the root moved onto the true one, the root
/// being the mean of the joints whose names contain "hip"; after the similarity that fits best (Procrustes; Umeyama
/// 1991). NaN where a mean or a fit has too few joints.
struct MeanErrors {
  double absolute_m = 0.0;
  double root_aligned_m = 0.0;
  double procrustes_m = 0.0;
};
MeanErrors mean_joint_errors(const JointPair& pair, const std::vector<std::string>& names);

/// Score and mean error of each joint and of all, of one person. Joints that were not found count as wrong in the
/// scores and not at all in the mean errors.
FigureTerms joint_terms(const JointPair& pair, const std::vector<std::string>& names);

/// Joints by distance: how many lie within 1, 2, ... kJointCurve_cm centimetres.
struct JointCurve {
  std::array<long, kJointCurve_cm> within{};
  long joints = 0;

  void add(const std::vector<double>& errors_m);
  double share(int cm) const;  ///< 1 to kJointCurve_cm; NaN without joints
};

/// How far behind its visible surface a joint's truth lies along the viewing ray: a sample for a depth_offset.
struct JointOffset {
  std::string set;
  std::string joint;
  double behind_m = 0.0;
};

/// Samples of the joints that both have; the set's own depth offsets are taken off.
std::vector<JointOffset> joint_offsets(const JointPair& pair, const std::vector<std::string>& names,
                                       const JointSet& set);

}  // namespace vesalius
