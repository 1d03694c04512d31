#pragma once

#include <NiteCAPI.h>

#include <Eigen/Geometry>

#include "vesalius/camera.h"
#include "vesalius/image.h"

namespace vesalius::nite2 {

/// How a stream of depth sees: what OpenNI says of it. The tracker sees pictures that are not mirrored, as cameras of
/// the optical frame; the interface has those of the stream, and an axis that goes up.
struct DepthView {
  int width = 0, height = 0;               ///< of the whole picture, pixels
  float across_rad = 0.F, down_rad = 0.F;  ///< fields of view
  bool mirrored = false;                   ///< left and right are exchanged

  /// Returns the camera of a picture, cropped or not, that is mirrored back. OpenNI's principal point is at half the
  /// width and height.
  Camera camera_of(const OniFrame& picture) const;

  /// Returns its depth in millimetres, mirrored back. Throws Error for another format than depth.
  DepthImage depth_of(const OniFrame& picture) const;

  /// Returns a point of the optical frame, metres, and a direction in it.
  NitePoint3f millimetres(const Eigen::Vector3f& metres) const;
  NitePoint3f direction(const Eigen::Vector3f& optical) const;
  /// Returns a turn of the optical frame.
  NiteQuaternion turn(const Eigen::Quaternionf& optical) const;

  /// Returns the column of the stream's picture for one of the tracker's, which has this width.
  int column(int u, int picture_width) const { return mirrored ? picture_width - 1 - u : u; }

  /// Returns where the whole picture shows a point, pixels. Its z must not be 0.
  Eigen::Vector2f pixel_of(const NitePoint3f& point) const;
  /// Returns the point that a pixel of it sees at `z_mm`.
  NitePoint3f point_of(float u, float v, float z_mm) const;
};

}  // namespace vesalius::nite2
