#include "vesalius/track/track_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace vesalius {
namespace {

constexpr double kUsualSpeed_m_s = 0.9;  // standard deviation of a walking person's velocity along an axis
constexpr double kSteady_s = 0.25;       // time without measurement until the velocity begins to fade
constexpr double kFade_s = 1.5;          // in which it then falls to 1/e
constexpr double kPush = 2.0 * kUsualSpeed_m_s * kUsualSpeed_m_s / kFade_s;  // density of the acceleration, m^2/s^3

double square(double x) { return x * x; }

constexpr float kSpeedCutoff_hz = 1.F;  // of the low pass of the velocity, as its authors have it

/// Returns the share of a new value that a low pass takes over.
float share(float cutoff_hz, float passed_s) {
  const float delay_s = 1.F / (2.F * std::numbers::pi_v<float> * cutoff_hz);
  return passed_s / (passed_s + delay_s);
}

}  // namespace

TrackMotion::TrackMotion(Eigen::Vector3f position, float sigma_m) : position_(std::move(position)) {
  covariance_ << square(double(sigma_m)), 0.0, 0.0, square(kUsualSpeed_m_s);
}

// Both kinds of step are exact solutions, so that two half steps are one whole step.
void TrackMotion::predict(double step_s) {
  const double steady = std::clamp(kSteady_s - unseen_s_, 0.0, step_s);
  if (steady > 0.0) go_on(steady);
  if (step_s > steady) fade(step_s - steady);
  unseen_s_ += step_s;
}

/// A constant velocity with white acceleration.
void TrackMotion::go_on(double step_s) {
  position_ += float(step_s) * velocity_;
  Eigen::Matrix2d transition, noise;
  transition << 1.0, step_s, 0.0, 1.0;
  noise << step_s * step_s * step_s / 3.0, step_s * step_s / 2.0, step_s * step_s / 2.0, step_s;
  covariance_ = (transition * covariance_ * transition.transpose() + kPush * noise).eval();
}

/// The velocity is an Ornstein-Uhlenbeck process, as in Singer's manoeuvring target (1970), and the position its
/// integral.
void TrackMotion::fade(double step_s) {
  const double left = std::exp(-step_s / kFade_s);
  const double travel = kFade_s * (1.0 - left);
  position_ += float(travel) * velocity_;
  velocity_ *= float(left);
  Eigen::Matrix2d transition, noise;
  transition << 1.0, travel, 0.0, left;
  const double variance = square(kUsualSpeed_m_s);
  const double both = kFade_s * variance * square(1.0 - left);
  const double place = variance * kFade_s * (2.0 * step_s - kFade_s * (3.0 - 4.0 * left + left * left));
  noise << std::max(0.0, place), both, both, variance * (1.0 - left * left);
  covariance_ = (transition * covariance_ * transition.transpose() + noise).eval();
}

void TrackMotion::stop_at(const FloorView& floor) {
  const float below_m = -(floor.height_m + floor.up.dot(position_));
  if (!(below_m > 0.F)) return;
  position_ += below_m * floor.up;
  velocity_ -= std::min(0.F, floor.up.dot(velocity_)) * floor.up;
}

void TrackMotion::update(const Eigen::Vector3f& position, float sigma_m) {
  const double measured = covariance_(0, 0) + square(double(sigma_m));
  const Eigen::Vector2d gain = covariance_.col(0) / measured;
  const Eigen::Vector3f off = position - position_;
  position_ += float(gain(0)) * off;
  velocity_ += float(gain(1)) * off;
  covariance_ = (covariance_ - gain * covariance_.row(0)).eval();
  unseen_s_ = 0.0;
}

float TrackMotion::sigma_m() const { return float(std::sqrt(covariance_(0, 0))); }

float TrackMotion::distance2(const Eigen::Vector3f& position, float sigma_m) const {
  const auto variance = float(covariance_(0, 0)) + sigma_m * sigma_m;
  return (position - position_).squaredNorm() / variance;
}

std::vector<std::vector<Joint>> JointSmoother::smooth(const std::vector<std::vector<Joint>>& joints, double passed_s,
                                                      const JointSmoothing& options) {
  const auto step_s = float(passed_s);
  std::vector<std::vector<Joint>> smoothed = joints;
  filters_.resize(joints.size());
  for (std::size_t set = 0; set < joints.size(); ++set) {
    filters_[set].resize(joints[set].size());
    for (std::size_t j = 0; j < joints[set].size(); ++j) {
      const Joint& joint = joints[set][j];
      Filter& filter = filters_[set][j];
      if (joint.state == State::none || !joint.position.allFinite()) {
        filter = {};
        continue;
      }
      if (!filter.known) {
        filter = {true, joint.position, Eigen::Vector3f::Zero(), joint.position};
      } else if (step_s > 0.F) {
        const Eigen::Vector3f velocity = (joint.position - filter.raw) / step_s;
        filter.velocity += share(kSpeedCutoff_hz, step_s) * (velocity - filter.velocity);
        const float cutoff = options.cutoff_hz + options.cutoff_per_m_s * filter.velocity.norm();
        filter.position += share(cutoff, step_s) * (joint.position - filter.position);
        filter.raw = joint.position;
      }
      smoothed[set][j].position = filter.position;
    }
  }
  return smoothed;
}

}  // namespace vesalius
