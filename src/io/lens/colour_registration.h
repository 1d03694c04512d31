#pragma once

#include <Eigen/Geometry>
#include <array>

#include "io/lens/lens.h"
#include "vesalius/image.h"

namespace vesalius {

/// Gives each pixel of a depth picture the colour that another camera saw there.
///
/// A pixel that something nearer to the colour camera hides has that thing's colour in the colour picture, not its own:
/// beside a person the wall would wear the person's clothes, and the person's mask, which grows by colour too, would
/// run into it. Such pixels are black, as are those without depth and those outside of the colour picture.
class ColourRegistration {
 public:
  /// `colour_from_depth` takes points in the frame of the depth camera (metres) to that of the colour camera. Throws
  /// Error if a camera has no size.
  ColourRegistration(const Camera& depth, const LensCamera& colour, const Eigen::Isometry3d& colour_from_depth);

  /// Returns whether a picture has the size of the colour camera's.
  bool fits(const ColourImage& colour) const {
    return colour.width() == colour_.camera.width && colour.height() == colour_.camera.height;
  }
  /// Returns a picture of the size of `depth` (millimetres). Both must have the size of their cameras; throws Error
  /// otherwise.
  ColourImage operator()(const DepthImage& depth, const ColourImage& colour) const;

 private:
  Camera depth_;
  LensCamera colour_;
  Eigen::Isometry3f colour_from_depth_;
  std::array<float, 8> k_{};
  int cell_bits_ = 0;  ///< squares of 2^bits pixels of colour count as one in telling what hides what
};

}  // namespace vesalius
