#include "vesalius/track/track_motion.h"

#include <cmath>

namespace vesalius {
namespace {

constexpr double kUsualSpeed_m_s = 0.9;  // standard deviation of a walking person's velocity along an axis
constexpr double kFade_s = 1.5;          // in which a velocity nobody sees falls to 1/e

double square(double x) { return x * x; }

}  // namespace

TrackMotion::TrackMotion(const Eigen::Vector3f& position, float sigma_m) : position_(position) {
  covariance_ << square(static_cast<double>(sigma_m)), 0.0, 0.0, square(kUsualSpeed_m_s);
}

// The velocity is an Ornstein-Uhlenbeck process, as in Singer's manoeuvring target (1970), and the position its
// integral; the noise is that of the exact solution, so that two half steps are one whole step.
void TrackMotion::predict(double step_s) {
  const double left = std::exp(-step_s / kFade_s);
  const double travel = kFade_s * (1.0 - left);
  position_ += static_cast<float>(travel) * velocity_;
  velocity_ *= static_cast<float>(left);
  Eigen::Matrix2d transition;
  transition << 1.0, travel, 0.0, left;
  const double variance = square(kUsualSpeed_m_s);
  const double pushed = kFade_s * variance * square(1.0 - left);
  const double place = variance * kFade_s * (2.0 * step_s - kFade_s * (3.0 - 4.0 * left + left * left));
  Eigen::Matrix2d noise;
  noise << std::max(0.0, place), pushed, pushed, variance * (1.0 - left * left);
  covariance_ = (transition * covariance_ * transition.transpose() + noise).eval();
}

void TrackMotion::update(const Eigen::Vector3f& position, float sigma_m) {
  const double measured = covariance_(0, 0) + square(static_cast<double>(sigma_m));
  const Eigen::Vector2d gain = covariance_.col(0) / measured;
  const Eigen::Vector3f off = position - position_;
  position_ += static_cast<float>(gain(0)) * off;
  velocity_ += static_cast<float>(gain(1)) * off;
  covariance_ = (covariance_ - gain * covariance_.row(0)).eval();
}

float TrackMotion::sigma_m() const { return static_cast<float>(std::sqrt(covariance_(0, 0))); }

float TrackMotion::distance2(const Eigen::Vector3f& position, float sigma_m) const {
  const auto variance = static_cast<float>(covariance_(0, 0)) + sigma_m * sigma_m;
  return (position - position_).squaredNorm() / variance;
}

}  // namespace vesalius
