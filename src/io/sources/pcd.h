#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <string_view>

#include "io/sources/camera_file.h"
#include "vesalius/frame_source.h"
#include "vesalius/image.h"

namespace vesalius {

/// An organised cloud: one point for each pixel, in metres in the optical frame.
struct PointGrid {
  Image<Eigen::Vector3f> points_m;  ///< z NaN or not positive = no reading
  ColourImage colour;               ///< empty, or the size of `points_m`
};

/// Reads a PCD file of version 0.7: ascii, binary or binary_compressed. It must have x, y, z (F 4 or F 8) and may have
/// rgb or rgba (4 bytes); other fields are skipped, and the order is free. VIEWPOINT is ignored. Throws Error naming
/// `name` and the header line or point if the file is damaged, truncated or not organised (HEIGHT 1).
PointGrid parse_pcd(std::string_view bytes, const std::string& name);

/// Returns the z of the points in millimetres, rounded. It is 0 where there is no point or the value exceeds 65535.
DepthImage depth_of(const PointGrid& grid);

/// Estimates the pinhole camera whose pixel grid the points lie on, by least squares. Throws Error naming `name` if
/// there are too few points or they lie on no such grid.
CameraFacts estimate_camera(const PointGrid& grid, const std::string& name);

/// Opens an organised PCD file, or all such files in a folder, as a source of frames. The camera comes from `options`
/// or from a camera file beside the clouds; otherwise it is estimated for each cloud from its points.
std::unique_ptr<FrameSource> open_pcd(const std::string& path, const SourceOptions& options);

}  // namespace vesalius
