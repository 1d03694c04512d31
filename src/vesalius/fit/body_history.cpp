#include "vesalius/fit/body_history.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vesalius/fit/flesh_sections.h"

namespace vesalius {
namespace {

constexpr double kLongest_s = 0.5;  // after this nobody knows the pose any more
constexpr double kFrame_s = 1.0 / 30.0;
constexpr double kFastest_m_s = 3.0;
constexpr double kFastest_rad_s = 12.0;
constexpr double kTurnShare = 0.5, kTurnKept = 0.8;  // the same of turns, and what of them goes on
constexpr double kVelocityShare = 0.3;               // of a new measurement of the velocity, in a frame
constexpr double kNews = 0.2;                        // share of a frame that is new: neighbouring frames err alike
constexpr double kKept = 0.998;                      // share of what was learned that a frame keeps: clothes move
constexpr float kDoubtful = 0.3F;                    // misfit of a body that may have lost its person ...
constexpr float kWrong = 0.4F;                       // ... and of one that surely tells nothing of its shape

/// Returns the matrix without negative eigenvalues, which rounding and local minima leave.
Eigen::MatrixXd positive(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 * (matrix + matrix.transpose()));
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() * solver.eigenvectors().transpose();
}

/// Returns the height of the lowest flesh over the ground, below 0 under it, metres.
double lowest_m(const FleshModel& flesh, const BodyState& state, const Ground& ground) {
  const auto below = [&](const Eigen::Vector3f& end, float radius) {
    return ground.height_of(end.cast<double>()) - double(radius);
  };
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto& [from, to, from_radius, to_radius] : flesh_capsules(flesh, state)) {
    lowest = std::min({lowest, below(from, from_radius), below(to, to_radius)});
  }
  return lowest;
}

}  // namespace

ExpectedBody BodyHistory::expect(const BodyFitter& fitter, double time_s, const std::optional<Ground>& ground,
                                 const Eigen::Vector3d& velocity) const {
  ExpectedBody expected;
  expected.ground = ground;
  expected.velocity = velocity;
  if (shape_.size() == fitter.flesh().shapes) {
    expected.shape = shape_;
    expected.shape_information = information_;
  } else {
    fitter.forget_shape(expected);
  }
  expected.pose = expected_state(fitter.flesh(), time_s);
  if (!expected.pose) return expected;
  expected.loosened = std::sqrt(std::max((time_s - last_->time_s) / kFrame_s, 1.0));
  const bool doubtful = misfit_ > kDoubtful || fitter.walks_backwards(expected);
  expected.start = doubtful ? frames_ % kStarts : -1;
  return expected;
}

std::optional<BodyState> BodyHistory::expected_state(const FleshModel& flesh, double time_s) const {
  if (!last_) return std::nullopt;
  const double passed_s = time_s - last_->time_s;
  if (!(passed_s >= 0.0) || passed_s > kLongest_s) return std::nullopt;
  BodyState state = last_->state;
  state.root += passed_s * last_->velocity;
  for (std::size_t b = 0; b < state.local.size(); ++b) {
    state.local[b] = (state.local[b] * exp_rotation(passed_s * last_->turning[b])).normalized();
  }
  if (!last_->ground) return state;
  // The floor stops whoever falls, also between frames and where nobody sees it.
  const double now_m = lowest_m(flesh, state, *last_->ground);
  if (!(now_m < 0.0)) return state;
  const double before_m = std::min(0.0, lowest_m(flesh, last_->state, *last_->ground));
  state.root += std::max(0.0, before_m - now_m) * last_->ground->up;
  return state;
}

void BodyHistory::learn(const FleshModel& flesh, const BodyFit& fit, const ExpectedBody& expected) {
  const Eigen::MatrixXd& before = expected.shape_information;
  const Eigen::MatrixXd news = positive(fit.shape_information);
  // The frame's own estimate is what its information adds to what was known: news * own.
  const Eigen::VectorXd own = (before + news) * fit.state.shape - before * expected.shape;
  const Eigen::MatrixXd information = before + kNews * news;
  shape_ = information.llt().solve(before * expected.shape + kNews * own);
  const Eigen::MatrixXd usual = Eigen::MatrixXd::Identity(information.rows(), information.cols());
  information_ = usual + kKept * (information - usual);
  ++learned_;
  const double size = stature(flesh, shape_) / stature(flesh, Eigen::VectorXd::Zero(shape_.size()));
  if (std::isfinite(size) && size > 0.0) size_ = float(size);
}

std::optional<FittedBody> BodyHistory::fit(const BodyFitter& fitter, const Frame& frame, const Person& person,
                                           double time_s, const std::optional<Ground>& ground,
                                           const Eigen::Vector3d& velocity) {
  ExpectedBody expected = expect(fitter, time_s, ground, velocity);
  std::optional<BodyFit> found = fitter.fit(frame, person, expected);
  if (!found) return std::nullopt;
  if (found->restarted) {
    fitter.forget_shape(expected);
    learned_ = 0;
  }
  if (found->body.misfit <= kWrong) learn(fitter.flesh(), *found, expected);
  Eigen::Vector3d of_root = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> turning(found->state.local.size(), Eigen::Vector3d::Zero());
  if (expected.pose && !found->restarted && time_s > last_->time_s) {
    const Eigen::Vector3d now = (found->state.root - last_->state.root) / (time_s - last_->time_s);
    of_root = (1.0 - kVelocityShare) * last_->velocity + kVelocityShare * now;
    of_root *= std::min(1.0, kFastest_m_s / std::max(of_root.norm(), 1e-9));
    for (std::size_t b = 0; b < turning.size(); ++b) {
      const Eigen::Vector3d turn =
          log_rotation(last_->state.local[b].conjugate() * found->state.local[b]) / (time_s - last_->time_s);
      turning[b] = kTurnKept * ((1.0 - kTurnShare) * last_->turning[b] + kTurnShare * turn);
      turning[b] *= std::min(1.0, kFastest_rad_s / std::max(turning[b].norm(), 1e-9));
    }
  }
  last_ = Last{found->state, of_root, turning, ground, time_s};
  stature_m_ = found->body.stature_m;
  misfit_ = found->body.misfit;
  ++frames_;
  return std::move(found->body);
}

}  // namespace vesalius
