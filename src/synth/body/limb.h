#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <vector>

namespace vesalius::synth {

/// Cross-section of a limb.
struct Station {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float wide = 0.F;  ///< half axes of the ellipse, metres
  float deep = 0.F;
  float cap = 0.F;  ///< how far the limb reaches beyond this station where it is the first or last
};

/// Place along a limb from which on another bone moves it.
struct BoneChange {
  int bone = 0;
  float from_m = 0.F;   ///< along the limb, from the first station
  float blend_m = 0.F;  ///< half width of the stretch over which the bones before and after mix
};

/// A piece of a body: elliptic cross-sections strung on a line of straight pieces; with one station an ellipsoid.
struct Limb {
  std::vector<Station> stations;
  Eigen::Vector3f wide_axis = Eigen::Vector3f::UnitX();  ///< unit, across the line
  Eigen::Vector3f axis = Eigen::Vector3f::UnitY();       ///< unit; direction of a limb of one station
  std::vector<BoneChange> bones;                         ///< rising; the first from 0
  bool paired = false;                                   ///< the left one of two
};

struct LimbPoint {
  float distance_m = 0.F;  ///< to the surface, about; negative inside
  float along_m = 0.F;     ///< place of the nearest cross-section
};

/// Finds distances to one limb.
class LimbDistance {
 public:
  explicit LimbDistance(const Limb& limb);
  /// The surface nearest to p; a point further than `most_m` from it may be given that distance.
  LimbPoint nearest(const Eigen::Vector3f& p, float most_m = std::numeric_limits<float>::max()) const;

 private:
  struct Piece {
    Eigen::Vector3f head, across, deep, along;  ///< axes are unit
    float length, before;                       ///< metres; of the pieces before
    Station from, to;
    float reach;  ///< no point of the piece is further from its line
  };
  LimbPoint nearest_on(const Piece& piece, const Eigen::Vector3f& p, float best) const;
  std::vector<Piece> pieces_;
};

/// A box around a limb's surface.
struct Bounds {
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  Eigen::Vector3f high = Eigen::Vector3f::Zero();
};
Bounds bounds(const Limb& limb);

}  // namespace vesalius::synth
