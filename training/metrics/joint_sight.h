#pragma once

#include <Eigen/Core>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/joint_metrics.h"
#include "metrics/metric_table.h"

namespace vesalius {

/// Distance from a joint within which its person's surface counts for it, metres: half the width of a thick limb.
inline constexpr double kSightRadius_m = 0.15;
/// Smallest area of that surface that the camera sees of a joint that is seen, cm^2.
inline constexpr double kSight_cm2 = 10.0;

/// Whether the camera sees the body about a true joint.
enum class Sight {
  unknown,  ///< the person's pixels, or the joint, are not known
  seen,     ///< at least kSight_cm2 of the person lie within kSightRadius_m of it
  hidden,   ///< less does
};

/// Returns this of joints of a true person, metres, optical frame.
std::vector<Sight> joint_sight(const TrueFrame& frame, std::size_t person, const std::vector<Eigen::Vector3f>& joints);

/// Returns how many of the seen and of the hidden joints of a person lie within kJointTolerance_m, their mean errors,
/// and of the joints given out with a confidence from each tenth how many lie so, of all, of the seen and of the
/// hidden. As in joint_terms, joints that were not found count as wrong in the shares and are left out of the errors.
/// `confidences` and `sight` have the order of the pair.
MetricTerms sight_terms(const JointPair& pair, const std::vector<float>& confidences, const std::vector<Sight>& sight);

}  // namespace vesalius
