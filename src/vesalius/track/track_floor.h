#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "vesalius/person.h"

namespace vesalius {

/// The floor over time, from the planes of each frame. A level plane becomes the floor when it was seen for a while, so
/// that a table that is seen for a moment does not; one above the floor takes longer. Small differences are averaged
/// over seconds, as of a camera that stands still; larger ones that last are followed, as of one that moves.
class TrackFloor {
 public:
  /// Takes the planes of a frame (find_planes), `passed_s` seconds after the one before, and up in the optical frame as
  /// a sensor measured it, if one did. Without, up is that of the floor so far, or about `guess`.
  void update(const std::vector<Plane>& planes, const std::optional<Eigen::Vector3f>& up, double passed_s,
              const Eigen::Vector3f& guess = -Eigen::Vector3f::UnitY());
  /// Forgets all: the camera may be anywhere.
  void reset() { *this = {}; }

  /// Returns nothing before a floor was seen for long enough, and after none was seen for long, or for a moment in
  /// which all other planes have changed, too.
  std::optional<FloorView> view() const;

 private:
  void forget_if_moved(const std::vector<Plane>& planes, double passed_s);
  void follow(const Plane& seen, double passed_s);
  void doubt(const Plane& seen, double passed_s);

  std::optional<Plane> floor_;
  std::optional<Plane> rival_;  ///< a plane that may become the floor
  double rival_s_ = 0.0;        ///< seconds for which the rival has been seen
  int rival_frames_ = 0;
  double unseen_s_ = 0.0;      ///< seconds since the floor was seen
  std::vector<Plane> around_;  ///< planes that were seen with the floor
  double elsewhere_s_ = 0.0;   ///< seconds for which no plane of `around_` has been seen
};

/// Returns how the camera stands over a floor. The plane's normal points away from the camera.
FloorView view_of_floor(const Plane& floor);

/// Returns the transformation from the optical frame to one that is level and has its origin on the floor below the
/// camera, with the same axes otherwise: x right, y down, z away from the camera. Metres.
Eigen::Isometry3f floor_from_optical(const FloorView& view);

}  // namespace vesalius
