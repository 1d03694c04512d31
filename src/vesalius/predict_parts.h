#pragma once

#include <Eigen/Core>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/person.h"

namespace vesalius {

/// The place of a part that follows from others.
struct PredictedPart {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< metres, optical frame
  float sigma_m = 0.F;                               ///< standard deviation along each axis
};

/// Fewest known parts from which others are predicted: three tell how a body is turned.
inline constexpr int kLeastKnownParts = 3;
/// Least confidence of a predicted part. Places that are wrong more often than four times in five help nobody.
inline constexpr float kLeastPredictedConfidence = 0.2F;

/// Returns the places of all parts, also the known ones, given those that are known (NaN = not known): the known ones
/// are turned onto the distribution's mean, and the others' means and variances given them are those of a Gaussian.
/// Where pixels voted for parts, `voted` has one for each: those for parts that are not known are known too, less well.
/// What is known far from where the rest expects it counts less. Returns nothing if fewer than kLeastKnownParts are
/// known.
std::vector<PredictedPart> predict_parts(const PartDistribution& distribution,
                                         const std::vector<Eigen::Vector3f>& centres,
                                         const std::vector<VotedPart>& voted);

/// Returns where the surface of a part is whose volume has this centre, `depth_m` before it on the viewing ray.
inline Eigen::Vector3f surface_of(const Eigen::Vector3f& centre, float depth_m) {
  return centre - depth_m * centre.normalized();
}

/// Returns the probability that a predicted part lies within 10 cm of the truth.
float predicted_confidence(const PartDistribution::Confidence& confidence, float sigma_m);

/// Returns the votes that count for a skeleton: none if the distribution does not know how to take them.
const std::vector<VotedPart>& counted_votes(const PartDistribution& distribution, const Skeleton& skeleton);

/// Returns the skeleton with the centre of each observed part drawn to the votes for it: the mean of both, weighed by
/// their variances. Joints and other parts follow from these; a part's own centre stays that of its visible surface.
Skeleton drawn_to_votes(const PartDistribution& distribution, Skeleton skeleton);

/// Where the middle of a part's volume is.
struct KnownMiddle {
  Eigen::Vector3f at;    ///< metres, optical frame
  double sigma_m = 0.0;  ///< standard deviation along each axis
};
/// Returns this for each part, where it is observed as drawn to its votes, else by these; nothing if no votes count.
std::vector<KnownMiddle> known_middles(const PartDistribution& distribution, const Skeleton& skeleton);

/// Fills in the parts that were not observed. With a distribution in the body those get a place that reach
/// kLeastPredictedConfidence, votes included; without, those between two observed ones, on the line between these and
/// in the proportion of the link lengths, with half of the weaker neighbour's confidence. Their state is predicted.
void predict_missing_parts(const BodyModel& body, Skeleton& skeleton);

/// Returns the rotation that turns `from` onto `onto` with the least squared error, with the columns' weights, both
/// taken from their weighted means (Kabsch 1976).
Eigen::Matrix3d best_rotation(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& onto,
                              const Eigen::VectorXd& weights);

}  // namespace vesalius
