#include "vesalius/predict_parts.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "vesalius/base/logistic.h"
#include "vesalius/vote_parts.h"

namespace vesalius {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kRounds = 4;  ///< rounds of turning and reweighting; more change no place by more than some millimetres
/// A known part this far from where the others expect it counts half: three times the usual error of a centre.
constexpr double kHalfTrusted_m = 0.15;
/// How far the known parts' mean may lie from where it belongs, standard deviation.
constexpr double kShift_m = 0.1;

struct Neighbour {
  const SkeletonPart* part = nullptr;
  float length_m = 0.F;
};

/// Returns the observed parts that are linked to `index`.
std::vector<Neighbour> observed_neighbours(const BodyModel& body, const Skeleton& skeleton, int index) {
  std::vector<Neighbour> found;
  for (const BodyLink& link : body.links) {
    const int other = link.parent == index ? link.child : link.child == index ? link.parent : -1;
    if (other < 0) continue;
    const SkeletonPart& part = skeleton.parts[other];
    if (part.state == State::observed) found.push_back({&part, link.length_m});
  }
  return found;
}

void interpolate_missing_parts(const BodyModel& body, Skeleton& skeleton) {
  std::vector<SkeletonPart> predicted = skeleton.parts;
  for (int i = 0; i < body.part_count(); ++i) {
    SkeletonPart& part = predicted[i];
    if (part.state != State::none) continue;
    const std::vector<Neighbour> around = observed_neighbours(body, skeleton, i);
    if (around.size() != 2) continue;
    const float share = around[0].length_m / (around[0].length_m + around[1].length_m);
    part.state = State::predicted;
    part.centre = around[0].part->centre + share * (around[1].part->centre - around[0].part->centre);
    part.confidence = 0.5F * std::min(around[0].part->confidence, around[1].part->confidence);
  }
  skeleton.parts = std::move(predicted);
}

/// The distribution as matrices: a body's places are mean + basis * b with b of independent standard normals, the last
/// three of which shift the whole body, plus a residual of each part.
struct Gaussian {
  explicit Gaussian(const PartDistribution& d)
      : mean(3, static_cast<Index>(d.parts.size())), basis(3 * mean.cols(), d.factors + 3), residual2(mean.cols()) {
    for (Index p = 0; p < mean.cols(); ++p) {
      const PartDistribution::Part& part = d.parts[p];
      residual2[p] = double(part.residual_m) * double(part.residual_m);
      for (Index axis = 0; axis < 3; ++axis) {
        mean(axis, p) = double(part.mean_m[axis]);
        for (int k = 0; k < d.factors; ++k)
          basis(3 * p + axis, k) = double(part.factors_m[axis][static_cast<std::size_t>(k)]);
        for (Index k = 0; k < 3; ++k) basis(3 * p + axis, d.factors + k) = axis == k ? kShift_m : 0.0;
      }
    }
  }

  /// Returns the variance of a part's place along an axis, without the shift of the whole body.
  double variance(Index part) const {
    return basis.block(3 * part, 0, 3, basis.cols() - 3).squaredNorm() / 3.0 + residual2[part];
  }

  Matrix3Xd mean;
  MatrixXd basis;  ///< rows: three of each part
  VectorXd residual2;
};

/// Where the visible surface of a part is, or would be.
struct KnownPlace {
  Index part;
  Eigen::Vector3f at;
  double noise2;  ///< variance along an axis
};

std::vector<KnownPlace> known_places(const PartDistribution& distribution, const std::vector<Eigen::Vector3f>& centres,
                                     const std::vector<VotedPart>& voted) {
  std::vector<KnownPlace> known;
  for (std::size_t p = 0; p < centres.size(); ++p) {
    if (centres[p].allFinite()) {
      known.push_back({Index(p), centres[p], double(distribution.noise_m) * double(distribution.noise_m)});
    } else if (!voted.empty()) {
      const double sigma_m = voted_sigma_m(voted[p]);
      known.push_back({Index(p), surface_of(voted[p].centre, distribution.parts[p].depth_m), sigma_m * sigma_m});
    }
  }
  return known;
}

/// Returns the weight of votes in the mean of what is observed of a part and what is voted, by their variances.
double share_of_votes(const PartDistribution::Part& part, const VotedPart& voted) {
  const double ratio = double(part.observed_m) / voted_sigma_m(voted);
  return ratio * ratio / (1.0 + ratio * ratio);
}

}  // namespace

Eigen::Matrix3d best_rotation(const Matrix3Xd& from, const Matrix3Xd& onto, const VectorXd& weights) {
  const VectorXd w = weights / weights.sum();
  const Eigen::Vector3d from_mean = from * w, onto_mean = onto * w;
  const Eigen::Matrix3d covariance =
      (from.colwise() - from_mean) * w.asDiagonal() * (onto.colwise() - onto_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if ((svd.matrixV() * svd.matrixU().transpose()).determinant() < 0.0) signs.z() = -1.0;  // no mirror image
  return svd.matrixV() * signs.asDiagonal() * svd.matrixU().transpose();
}

std::vector<PredictedPart> predict_parts(const PartDistribution& distribution,
                                         const std::vector<Eigen::Vector3f>& centres,
                                         const std::vector<VotedPart>& voted) {
  const std::vector<KnownPlace> known = known_places(distribution, centres, voted);
  const auto count = static_cast<Index>(known.size());
  if (count < kLeastKnownParts) return {};
  const Gaussian gaussian(distribution);
  Matrix3Xd seen(3, count), expected(3, count);
  MatrixXd basis(3 * count, gaussian.basis.cols());
  VectorXd noise(count), stiffness(count), trust = VectorXd::Ones(count);
  for (Index i = 0; i < count; ++i) {
    const auto& [part, place, noise2] = known[static_cast<std::size_t>(i)];
    seen.col(i) = place.cast<double>();
    expected.col(i) = gaussian.mean.col(part);
    basis.middleRows(3 * i, 3) = gaussian.basis.middleRows(3 * part, 3);
    noise[i] = gaussian.residual2[part] + noise2;
    stiffness[i] = 1.0 / (gaussian.variance(part) + noise2);
  }
  const auto part_of = [&](Index i) { return known[static_cast<std::size_t>(i)].part; };
  Eigen::Matrix3d turn;
  Eigen::Vector3d shift;  // a place in the camera's frame is turn^T * (place in the distribution's + shift)
  Matrix3Xd places;
  MatrixXd squares;
  for (int round = 0; round < kRounds; ++round) {
    const VectorXd weights = stiffness.cwiseProduct(trust);
    turn = best_rotation(seen, expected, weights);
    shift = (turn * seen - expected) * weights / weights.sum();
    const Matrix3Xd turned = (turn * seen).colwise() - shift;
    VectorXd row_weights(3 * count), off(3 * count);
    for (Index i = 0; i < count; ++i) {
      row_weights.segment<3>(3 * i).setConstant(trust[i] / noise[i]);
      off.segment<3>(3 * i) = turned.col(i) - gaussian.mean.col(part_of(i));
    }
    const MatrixXd weighted = row_weights.asDiagonal() * basis;
    squares.noalias() = basis.transpose() * weighted;
    squares.diagonal().array() += 1.0;
    const VectorXd products = weighted.transpose() * off;
    const VectorXd offsets = gaussian.basis * squares.llt().solve(products);
    places = gaussian.mean + Eigen::Map<const Matrix3Xd>(offsets.data(), 3, gaussian.mean.cols());
    for (Index i = 0; i < count; ++i) {
      expected.col(i) = places.col(part_of(i));
      trust[i] = 1.0 / (1.0 + (turned.col(i) - expected.col(i)).squaredNorm() / (kHalfTrusted_m * kHalfTrusted_m));
    }
  }
  const MatrixXd spread = squares.llt().solve(gaussian.basis.transpose());
  std::vector<PredictedPart> predicted;
  for (Index p = 0; p < places.cols(); ++p) {
    const double variance =
        (gaussian.basis.middleRows(3 * p, 3) * spread.middleCols(3 * p, 3)).trace() / 3.0 + gaussian.residual2[p];
    const Eigen::Vector3d centre = turn.transpose() * (places.col(p) + shift);
    predicted.push_back({centre.cast<float>(), float(std::sqrt(variance))});
  }
  return predicted;
}

float predicted_confidence(const PartDistribution::Confidence& confidence, float sigma_m) {
  return logistic(confidence.bias + confidence.slope * std::log(sigma_m));
}

const std::vector<VotedPart>& counted_votes(const PartDistribution& distribution, const Skeleton& skeleton) {
  static const std::vector<VotedPart> none;
  return distribution.voted_confidence ? skeleton.voted : none;
}

Skeleton drawn_to_votes(const PartDistribution& distribution, Skeleton skeleton) {
  const std::vector<VotedPart>& voted = counted_votes(distribution, skeleton);
  for (std::size_t p = 0; p < voted.size(); ++p) {
    SkeletonPart& part = skeleton.parts[p];
    if (part.state != State::observed) continue;
    const Eigen::Vector3f by_votes = surface_of(voted[p].centre, distribution.parts[p].depth_m);
    part.centre += float(share_of_votes(distribution.parts[p], voted[p])) * (by_votes - part.centre);
  }
  return skeleton;
}

std::vector<KnownMiddle> known_middles(const PartDistribution& distribution, const Skeleton& skeleton) {
  std::vector<KnownMiddle> middles;
  const std::vector<VotedPart>& voted = counted_votes(distribution, skeleton);
  const Skeleton drawn = drawn_to_votes(distribution, skeleton);
  for (std::size_t p = 0; p < voted.size(); ++p) {
    const PartDistribution::Part& part = distribution.parts[p];
    const double of_votes_m = voted_sigma_m(voted[p]);
    if (drawn.parts[p].state == State::observed) {
      const Eigen::Vector3f& surface = drawn.parts[p].centre;
      // Votes for parts that are seen are off by half as much as those for hidden ones.
      const double of_both_m = 0.5 * of_votes_m * std::sqrt(share_of_votes(part, voted[p]));
      middles.push_back(
          {surface + part.depth_m * surface.normalized(), std::max(of_both_m, double(distribution.noise_m))});
    } else {
      middles.push_back({voted[p].centre, of_votes_m});
    }
  }
  return middles;
}

void predict_missing_parts(const BodyModel& body, Skeleton& skeleton) {
  if (body.distribution.parts.empty()) return interpolate_missing_parts(body, skeleton);
  std::vector<Eigen::Vector3f> centres;
  for (const SkeletonPart& part : drawn_to_votes(body.distribution, skeleton).parts) {
    const bool known = part.state == State::observed;
    centres.push_back(known ? part.centre : Eigen::Vector3f::Constant(std::nanf("")));
  }
  const std::vector<VotedPart>& voted = counted_votes(body.distribution, skeleton);
  const PartDistribution::Confidence& trust =
      voted.empty() ? body.distribution.confidence : *body.distribution.voted_confidence;
  const std::vector<PredictedPart> predicted = predict_parts(body.distribution, centres, voted);
  for (std::size_t p = 0; p < predicted.size(); ++p) {
    SkeletonPart& part = skeleton.parts[p];
    const float confidence = predicted_confidence(trust, predicted[p].sigma_m);
    if (part.state != State::none || confidence < kLeastPredictedConfidence) continue;
    part.state = State::predicted;
    part.centre = predicted[p].centre;
    part.confidence = confidence;
  }
}

}  // namespace vesalius
