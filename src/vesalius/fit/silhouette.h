#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// The outline of a person in the picture, on a coarse grid: for every place the nearest one that the person's flesh
/// may be seen at.
class Silhouette {
 public:
  /// `mask` is 1 on the person's pixels.
  Silhouette(const Frame& frame, const Mask& mask, const Box& box);

  /// What the camera sees where a point of the body would be.
  struct Sight {
    enum class Kind {
      unknown,  ///< nothing: off the picture or without a reading
      on,       ///< the person
      behind,   ///< something else, farther away than the point: the point is not there
      covered   ///< something nearer than the point
    };
    Kind kind = Kind::unknown;
    double depth_m = 0.0;                             ///< depth of the person at that place, for `on`
    Eigen::Vector2d aside = Eigen::Vector2d::Zero();  ///< pixels to the nearest place of the person, for `behind`
  };
  /// `margin_m` is how much nearer than the point something else must be to cover it.
  float focal_px() const { return frame_.camera.fx; }
  Sight look(const Eigen::Vector3d& point, double margin_m) const;

 private:
  const Frame& frame_;
  const Mask& mask_;
  Box box_;       ///< the grid's part of the picture
  int step_ = 1;  ///< pixels between places of the grid
  int columns_ = 0, rows_ = 0;
  std::vector<std::int32_t> nearest_;  ///< [row * columns + column]: index of the nearest place of the person
};

}  // namespace vesalius
