#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <vector>

namespace vesalius::synth {

/// A cross-section of a limb.
struct Station {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float wide = 0.F;  ///< half axes of the ellipse in metres
  float deep = 0.F;
  float cap = 0.F;  ///< how far the limb extends beyond its first or last station
};

/// A place along a limb where the bone that moves it changes.
struct BoneChange {
  int bone = 0;
  float from_m = 0.F;   ///< distance along the limb from the first station
  float blend_m = 0.F;  ///< half the length over which the bones before and after are blended
};

/// A piece of a body: elliptic cross-sections along a line of straight segments. With one station it is an ellipsoid.
struct Limb {
  std::vector<Station> stations;
  Eigen::Vector3f wide_axis = Eigen::Vector3f::UnitX();  ///< unit vector across the line
  Eigen::Vector3f axis = Eigen::Vector3f::UnitY();       ///< unit vector; direction of a limb with one station
  std::vector<BoneChange> bones;                         ///< in rising order; the first begins at 0
  bool paired = false;                                   ///< whether this is the left one of two
};

struct LimbPoint {
  float distance_m = 0.F;  ///< approximate distance to the surface; negative inside
  float along_m = 0.F;     ///< position of the nearest cross-section along the limb
};

/// Computes distances to one limb.
class LimbDistance {
 public:
  explicit LimbDistance(const Limb& limb);
  /// Returns the nearest point of the surface. For a point farther than `most_m` from it, the result may just say
  /// `most_m`.
  LimbPoint nearest(const Eigen::Vector3f& p, float most_m = std::numeric_limits<float>::max()) const;

 private:
  struct Piece {
    Eigen::Vector3f head, across, deep, along;  ///< axes are unit vectors
    float length, before;                       ///< length of this segment and of those before it, metres
    Station from, to;
    float reach;  ///< largest distance of the segment's surface from its line
  };
  LimbPoint nearest_on(const Piece& piece, const Eigen::Vector3f& p, float best) const;
  std::vector<Piece> pieces_;
};

/// The bounding box of a limb's surface.
struct Bounds {
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  Eigen::Vector3f high = Eigen::Vector3f::Zero();
};
Bounds bounds(const Limb& limb);

}  // namespace vesalius::synth
