#include "learn/fit_distribution.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "metrics/joint_metrics.h"
#include "metrics/statistics.h"
#include "vesalius/base/logistic.h"
#include "vesalius/error.h"
#include "vesalius/predict_parts.h"

namespace vesalius {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3f;

constexpr std::size_t kLeastPeople = 100;
/// Observed centres beyond this are those of other things; they say nothing about a part's depth.
constexpr float kOnPart_m = 0.2F;
/// Standard deviation along an axis of the centres observed on their part.
constexpr float kNoise_m = 0.04F;
/// What is tried as the standard deviation of an observed centre beside votes.
constexpr std::array kObserved_m{0.F, 0.01F, 0.02F, 0.03F, 0.04F, 0.06F, 0.08F, 0.1F, 0.12F, 0.16F, 0.2F, 0.3F, 0.4F};
constexpr int kRounds = 8;  ///< rounds of turning all bodies onto their mean

bool complete(const KnownPerson& person) {
  return !person.part_centres.empty() &&
         std::ranges::all_of(person.part_centres, [](const Vector3f& c) { return c.allFinite(); });
}

/// Returns how far each part's centre lies behind its visible surface along the viewing ray, the same for both sides.
std::vector<float> depths_of(const std::vector<KnownPerson>& people, const BodyModel& body) {
  std::vector<std::vector<double>> samples(body.parts.size());
  for (const KnownPerson& person : people) {
    for (std::size_t p = 0; p < person.part_centres.size(); ++p) {
      const SkeletonPart& part = person.skeleton.parts[p];
      const Vector3f off = person.part_centres[p] - part.centre;
      if (part.state != State::observed || !off.allFinite() || off.norm() > kOnPart_m) continue;
      const auto behind_m = double(off.dot(part.centre.normalized()));
      samples[p].push_back(behind_m);
      if (body.parts[p].mirror != int(p)) samples[body.parts[p].mirror].push_back(behind_m);
    }
  }
  std::vector<float> depths;
  depths.reserve(samples.size());
  for (std::vector<double>& of_part : samples) depths.push_back(float(median(std::move(of_part))));
  return depths;
}

/// Returns where a person's parts would be observed if nothing hid them.
std::vector<Vector3f> surfaces_of(const KnownPerson& person, const std::vector<float>& depths_m) {
  std::vector<Vector3f> surfaces;
  surfaces.reserve(person.part_centres.size());
  for (std::size_t p = 0; p < person.part_centres.size(); ++p) {
    surfaces.push_back(surface_of(person.part_centres[p], depths_m[p]));
  }
  return surfaces;
}

/// Returns the bodies, one in a matrix of the parts' columns, and their mirror images.
std::vector<Matrix3Xd> bodies_of(const std::vector<KnownPerson>& people, const std::vector<float>& depths_m,
                                 const BodyModel& body) {
  std::vector<Matrix3Xd> bodies;
  for (const KnownPerson& person : people) {
    if (!complete(person)) continue;
    const std::vector<Vector3f> surfaces = surfaces_of(person, depths_m);
    Matrix3Xd one(3, body.part_count()), other(3, body.part_count());
    for (int p = 0; p < body.part_count(); ++p) {
      one.col(p) = surfaces[p].cast<double>();
      other.col(body.parts[p].mirror) = one.col(p);
    }
    other.row(0) *= -1.0;
    bodies.push_back(std::move(one));
    bodies.push_back(std::move(other));
  }
  return bodies;
}

/// Turns and shifts all bodies onto their mean (generalised Procrustes analysis), and returns this.
Matrix3Xd align(std::vector<Matrix3Xd>& bodies) {
  Matrix3Xd mean = bodies.front().colwise() - bodies.front().rowwise().mean();
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(mean.cols());
  for (int round = 0; round < kRounds; ++round) {
    Matrix3Xd sum = Matrix3Xd::Zero(3, mean.cols());
    for (Matrix3Xd& one : bodies) {
      const Eigen::Matrix3d turn = best_rotation(one, mean, weights);
      const Eigen::Vector3d shift = (turn * one - mean) * weights / weights.sum();
      one = ((turn * one).colwise() - shift).eval();
      sum += one;
    }
    mean = sum / double(bodies.size());
    const Eigen::Vector3d middle = mean.rowwise().mean();
    mean.colwise() -= middle;
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(mean.cols());
    for (Matrix3Xd& one : bodies) {
      one.colwise() -= middle;
      squares += (one - mean).colwise().squaredNorm().transpose();
    }
    // What moves little tells best how a body is turned.
    const double noise2 = double(kNoise_m) * double(kNoise_m);
    weights = (squares.array() / (3.0 * double(bodies.size())) + noise2).inverse();
  }
  return mean;
}

PartDistribution distribution_of(const std::vector<Matrix3Xd>& bodies, const Matrix3Xd& mean,
                                 const std::vector<float>& depths_m) {
  const Index rows = 3 * mean.cols();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(rows, rows);
  for (const Matrix3Xd& one : bodies) {
    const Matrix3Xd off = one - mean;
    const Eigen::Map<const Eigen::VectorXd> offsets(off.data(), rows);
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(offsets);
  }
  covariance /= double(bodies.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  PartDistribution distribution;
  distribution.factors = int(std::min<Index>(kDistributionFactors, rows));
  distribution.noise_m = kNoise_m;
  for (Index p = 0; p < mean.cols(); ++p) {
    PartDistribution::Part& part = distribution.parts.emplace_back();
    double rest = 0.0;
    for (Index axis = 0; axis < 3; ++axis) {
      const Index row = 3 * p + axis;
      part.mean_m[axis] = float(mean(axis, p));
      rest += covariance(row, row);
      for (int k = 0; k < distribution.factors; ++k) {
        const Index column = rows - 1 - k;  // the largest come last
        const double factor =
            solver.eigenvectors()(row, column) * std::sqrt(std::max(0.0, solver.eigenvalues()[column]));
        part.factors_m[axis].push_back(float(factor));
        rest -= factor * factor;
      }
    }
    part.residual_m = float(std::sqrt(std::max(0.0, rest / 3.0)));
    part.depth_m = depths_m[static_cast<std::size_t>(p)];
  }
  return distribution;
}

/// Returns how far off the observed parts of all people are in sum, drawn to their votes; of both sides together.
std::vector<double> sums_off_m(const std::vector<KnownPerson>& people, const std::vector<float>& depths_m,
                               const BodyModel& body, const PartDistribution& distribution) {
  std::vector<double> sums(body.parts.size(), 0.0);
  for (const KnownPerson& person : people) {
    const Skeleton drawn = drawn_to_votes(distribution, person.skeleton);
    const std::vector<Vector3f> surfaces = surfaces_of(person, depths_m);
    for (std::size_t p = 0; p < surfaces.size(); ++p) {
      if (drawn.parts[p].state != State::observed || !surfaces[p].allFinite()) continue;
      const auto off_m = double(std::min((drawn.parts[p].centre - surfaces[p]).norm(), kOnPart_m));
      sums[p] += off_m;
      if (body.parts[p].mirror != int(p)) sums[body.parts[p].mirror] += off_m;
    }
  }
  return sums;
}

/// Fits how far off observed centres are beside votes: where both together are least off.
void fit_observed(const std::vector<KnownPerson>& people, const std::vector<float>& depths_m, const BodyModel& body,
                  PartDistribution& distribution) {
  std::vector<double> least(body.parts.size(), std::numeric_limits<double>::infinity());
  PartDistribution tried = distribution;
  for (const float observed_m : kObserved_m) {
    for (PartDistribution::Part& part : tried.parts) part.observed_m = observed_m;
    const std::vector<double> sums = sums_off_m(people, depths_m, body, tried);
    for (std::size_t p = 0; p < sums.size(); ++p) {
      if (sums[p] >= least[p]) continue;
      least[p] = sums[p];
      distribution.parts[p].observed_m = observed_m;
    }
  }
}

/// A predicted part.
struct Outcome {
  double log_sigma = 0.0;
  bool right = false;
};

/// Returns what is predicted with the votes of the people who have some, or of all people without any.
std::vector<Outcome> outcomes_of(const std::vector<KnownPerson>& people, const std::vector<float>& depths_m,
                                 const PartDistribution& distribution, bool voted) {
  std::vector<Outcome> outcomes;
  for (const KnownPerson& person : people) {
    if (person.part_centres.empty() || (voted && person.skeleton.voted.empty())) continue;
    const std::vector<Vector3f> surfaces = surfaces_of(person, depths_m);
    Skeleton observed = person.skeleton;
    for (SkeletonPart& part : observed.parts) {
      if (part.state == State::predicted) part.state = State::none;
    }
    if (!voted) observed.voted.clear();
    const std::vector<PredictedPart> predicted =
        predict_parts(distribution, given_centres(drawn_to_votes(distribution, observed)), observed.voted);
    for (std::size_t p = 0; p < predicted.size(); ++p) {
      if (observed.parts[p].state != State::none || !surfaces[p].allFinite()) continue;
      const double error_m = double((predicted[p].centre - surfaces[p]).norm());
      outcomes.push_back({std::log(double(predicted[p].sigma_m)), error_m < kJointTolerance_m});
    }
  }
  return outcomes;
}

/// Returns the confidence fitted by logistic regression (Newton's method).
PartDistribution::Confidence fit_confidence(const std::vector<Outcome>& outcomes) {
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  for (int round = 0; round < 30; ++round) {
    Eigen::Matrix2d curvature = 1e-3 * Eigen::Matrix2d::Identity();  // keeps it finite where all or none are right
    Eigen::Vector2d slope = -1e-3 * x;
    for (const Outcome& one : outcomes) {
      const Eigen::Vector2d row(1.0, one.log_sigma);
      const double p = logistic(row.dot(x));
      slope += ((one.right ? 1.0 : 0.0) - p) * row;
      curvature += std::max(p * (1.0 - p), 1e-6) * row * row.transpose();
    }
    x += curvature.ldlt().solve(slope);
  }
  return {float(x[0]), float(x[1])};
}

}  // namespace

PartDistribution fit_distribution(const std::vector<KnownPerson>& people, const BodyModel& body) {
  const std::vector<float> depths_m = depths_of(people, body);
  std::vector<Matrix3Xd> bodies = bodies_of(people, depths_m, body);
  if (bodies.size() < 2 * kLeastPeople) {
    throw Error(fmt::format("distribution of parts: {} people found whose parts' centres are all known, expected {}",
                            bodies.size() / 2, kLeastPeople));
  }
  const Matrix3Xd mean = align(bodies);
  PartDistribution distribution = distribution_of(bodies, mean, depths_m);
  distribution.confidence = fit_confidence(outcomes_of(people, depths_m, distribution, false));
  if (std::ranges::all_of(people, [](const KnownPerson& person) { return person.skeleton.voted.empty(); })) {
    return distribution;
  }
  distribution.voted_confidence = PartDistribution::Confidence{};  // so that votes count from here on
  fit_observed(people, depths_m, body, distribution);
  distribution.voted_confidence = fit_confidence(outcomes_of(people, depths_m, distribution, true));
  return distribution;
}

}  // namespace vesalius
