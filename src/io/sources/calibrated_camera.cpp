#include "io/sources/calibrated_camera.h"

#include <array>
#include <optional>

namespace vesalius {
namespace {

/// Returns whether rectified pictures are seen from the same place in the same direction, as those of one camera are.
bool keeps_direction(const Calibration& c) {
  const std::array<double, 9> same{1, 0, 0, 0, 1, 0, 0, 0, 1}, none{};
  return (c.rotation == same || c.rotation == none) && c.projection[3] == 0.0 && c.projection[7] == 0.0;
}

}  // namespace

CalibratedCamera calibrated(const Calibration& c, bool is_rectified) {
  const auto camera = [&](double fx, double fy, double cx, double cy) {
    return Camera{c.width, c.height, float(fx), float(fy), float(cx), float(cy)};
  };
  const Camera of_matrix = camera(c.matrix[0], c.matrix[4], c.matrix[2], c.matrix[5]);
  const std::optional<Lens> lens = make_lens(c.model, c.distortion);
  const bool distorted = lens != Lens{};
  const bool has_projection = c.projection[0] > 0.0 && c.projection[5] > 0.0;
  CalibratedCamera all{of_matrix, {of_matrix, {}}, {}};
  if (!distorted) return all;
  // What image_proc turns the pictures into.
  if (has_projection && (is_rectified || keeps_direction(c))) {
    all.pinhole = camera(c.projection[0], c.projection[5], c.projection[2], c.projection[6]);
  }
  if (is_rectified && has_projection) {
    all.lens.camera = all.pinhole;
  } else if (lens) {
    all.lens.lens = *lens;
  } else {
    all.pinhole = of_matrix;
    all.odd_model = c.model;
  }
  return all;
}

}  // namespace vesalius
