#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "vesalius/person.h"

namespace vesalius {

/// By how much joints of fitted bodies lie behind the true ones along the ray, metres: on rendered clips, mean of all
/// seen joints (docs/several-cameras.md). Two cameras would otherwise be taken for being that much off.
inline constexpr double kJointsBehind_m = 0.017;

/// Where a camera stands, as the people tell whom it and others see.
struct FoundPose {
  Eigen::Isometry3f first_from_this = Eigen::Isometry3f::Identity();  ///< optical frames, metres
  float residual_m = 0.F;  ///< median distance of the joints that it and the camera to which it is tied both see
  int to = -1;             ///< that camera
  int moments = 0;         ///< at which both saw somebody
};

/// Finds how cameras stand to each other from the people whom they see at the same time, who need not be known from
/// each other. The joints of somebody whom two cameras see lie on each other after a rigid transformation; who is who
/// is the choice of pairs with which most joints do. Where both cameras know the floor, that levels them too. Joints
/// err alike over moments, so that people who move about tell more than people who stand.
class PoseFinder {
 public:
  explicit PoseFinder(std::size_t cameras);

  /// Takes the people whom each camera sees at one moment, in its own optical frame; those at less than a fifth of a
  /// second after the moment before are left out. Throws Error for another number of cameras.
  void add(double time_s, const std::vector<TrackedFrame>& seen);

  /// Returns the pose of each camera, of the first the identity. Nothing as long as some are not tied to the others
  /// for sure: by three seconds with the same people, and only one way in which they can be the same.
  std::optional<std::vector<FoundPose>> find() const;

  /// Returns whether ten minutes are known; nothing is added then.
  bool is_full() const;

  /// Returns at how many moments somebody was seen by at least two cameras.
  int shared_moments() const { return shared_; }

 private:
  struct JointPlace {
    Eigen::Vector3d at;
    double variance_m2 = 0.0;  ///< along each axis; 0 where nothing is known
  };
  struct Sighted {
    int id = 0;
    std::vector<JointPlace> joints;
  };
  struct Moment {
    std::vector<std::vector<Sighted>> people;  ///< [camera]
  };
  struct Floor {
    Eigen::Vector3d up = Eigen::Vector3d::Zero();  ///< sum of all seen
    double height_m = 0.0;                         ///< the same
    int seen = 0;
  };
  class Pair;

  std::size_t cameras_;
  std::vector<Moment> moments_;
  std::vector<Floor> floors_;  ///< [camera]
  double last_s_ = 0.0;
  int shared_ = 0;
};

}  // namespace vesalius
