#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "io/sources/camera_file.h"
#include "vesalius/base/image.h"

namespace vesalius {

/// An organised cloud: one point per pixel, metres in the optical frame.
struct PointGrid {
  Image<Eigen::Vector3f> points_m;  ///< z NaN or not positive = no reading
  ColourImage colour;               ///< empty, or the size of `points_m`
};

/// Reads a PCD file of version 0.7: ascii, binary or binary_compressed; x, y, z (F 4 or F 8) and rgb or rgba (4 bytes)
/// among any other fields, in any order. VIEWPOINT is ignored. Throws Error naming `name` and the header line or point
/// for one that is damaged, truncated or not organised (HEIGHT 1).
PointGrid parse_pcd(std::string_view bytes, const std::string& name);

/// Millimetres of the points' z, rounded; 0 where there is none or it is over 65535.
DepthImage depth_of(const PointGrid& grid);

/// The pinhole camera whose grid the points lie on, by least squares. Throws Error naming `name` when there are too
/// few points or they lie on no such grid.
CameraFacts estimate_camera(const PointGrid& grid, const std::string& name);

}  // namespace vesalius
