#include "vesalius/track/track_motion.h"

#include <algorithm>
#include <cmath>

namespace vesalius {
namespace {

constexpr double kUsualSpeed_m_s = 0.9;  // standard deviation of a walking person's velocity along an axis
constexpr double kSteady_s = 0.25;       // time without measurement until the velocity begins to fade
constexpr double kFade_s = 1.5;          // in which it then falls to 1/e
constexpr double kPush = 2.0 * kUsualSpeed_m_s * kUsualSpeed_m_s / kFade_s;  // density of the acceleration, m^2/s^3

double square(double x) { return x * x; }

}  // namespace

TrackMotion::TrackMotion(const Eigen::Vector3f& position, float sigma_m) : position_(position) {
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

}  // namespace vesalius
