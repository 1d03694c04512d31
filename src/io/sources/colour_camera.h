#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "io/lens/lens.h"
#include "io/sources/camera_file.h"

namespace vesalius {

/// Colour of another camera than depth's.
struct ColourCamera {
  LensCamera lens;
  Eigen::Isometry3d colour_from_depth = Eigen::Isometry3d::Identity();  ///< metres
};

/// Returns the camera of colour pictures of `width` x `height` pixels, where calibrations of it and of depth's are
/// known, and how they stand to each other. Otherwise `missing` receives what is not known; it is empty where the
/// calibrations say nothing of colour. `depth` is the camera of the pictures of depth, made of `facts`.
std::optional<ColourCamera> find_colour_camera(const CameraFacts& facts, const Camera& depth, int width, int height,
                                               std::string& missing);

}  // namespace vesalius
