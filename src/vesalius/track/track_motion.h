#pragma once

#include <Eigen/Core>
#include <vector>

#include "vesalius/people_options.h"
#include "vesalius/person.h"

namespace vesalius {

/// Where the trunk of somebody who is followed is, and how it moves: a Kalman filter (1960) of position and velocity,
/// metres and seconds, in the optical frame. The velocity is constant but for random pushes, and fades while nobody is
/// seen for longer, as people stop and turn; a camera that moves evenly is part of it. All axes have the same
/// variances.
class TrackMotion {
 public:
  /// `sigma_m` is the standard deviation of the measured position along each axis.
  TrackMotion(Eigen::Vector3f position, float sigma_m);

  /// Goes on by `step_s` seconds, 0 or more.
  void predict(double step_s);
  /// Lets somebody who has fallen to the floor lie there: not below it, and no longer falling.
  void stop_at(const FloorView& floor);
  /// Takes a measured position.
  void update(const Eigen::Vector3f& position, float sigma_m);

  const Eigen::Vector3f& position() const { return position_; }
  const Eigen::Vector3f& velocity() const { return velocity_; }
  /// Returns the standard deviation of the position along each axis, metres.
  float sigma_m() const;
  /// Returns the squared distance of a measurement in standard deviations of its prediction (Mahalanobis).
  float distance2(const Eigen::Vector3f& position, float sigma_m) const;

 private:
  void go_on(double step_s);
  void fade(double step_s);

  Eigen::Vector3f position_;
  Eigen::Vector3f velocity_ = Eigen::Vector3f::Zero();
  Eigen::Matrix2d covariance_;  ///< covariance of position and velocity along an axis
  double unseen_s_ = 0.0;       ///< since the last measurement
};

/// Smooths the joints of one person over time by the One-Euro filter (Casiez, Roussel and Vogel 2012): a low pass whose
/// cutoff rises with the speed, so that joints at rest do not tremble and fast ones are not late. A joint that moves
/// evenly lags behind by 1 / (2 pi cutoff) seconds: 80 ms of its way as it begins to move, 20 ms at a metre a second.
class JointSmoother {
 public:
  /// Takes the joints of a frame, [set][joint], `passed_s` seconds after those before, and returns them smoothed. A
  /// joint without a place has none there either, and begins anew when it is back.
  std::vector<std::vector<Joint>> smooth(const std::vector<std::vector<Joint>>& joints, double passed_s,
                                         const JointSmoothing& options);

 private:
  struct Filter {
    bool known = false;
    Eigen::Vector3f position = Eigen::Vector3f::Zero();
    Eigen::Vector3f velocity = Eigen::Vector3f::Zero();
    Eigen::Vector3f raw = Eigen::Vector3f::Zero();
  };

  std::vector<std::vector<Filter>> filters_;
};

}  // namespace vesalius
