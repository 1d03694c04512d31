#include "nite2/depth_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "io/files/image_bytes.h"
#include "vesalius/error.h"

namespace vesalius::nite2 {
namespace {

/// Returns how many pixels there are to a unit along the axis.
float focal_length(int pixels, float field_rad) { return float(pixels) / (2.F * std::tan(field_rad / 2.F)); }

}  // namespace

Camera DepthView::camera_of(const OniFrame& picture) const {
  Camera camera{picture.width,      picture.height,     focal_length(width, across_rad), focal_length(height, down_rad),
                float(width) / 2.F, float(height) / 2.F};
  if (picture.croppingEnabled != 0) {
    camera.cx -= float(picture.cropOriginX);
    camera.cy -= float(picture.cropOriginY);
  }
  if (mirrored) camera.cx = float(picture.width - 1) - camera.cx;
  return camera;
}

DepthImage DepthView::depth_of(const OniFrame& picture) const {
  const OniPixelFormat format = picture.videoMode.pixelFormat;
  if (format != ONI_PIXEL_FORMAT_DEPTH_1_MM && format != ONI_PIXEL_FORMAT_DEPTH_100_UM) {
    throw Error(fmt::format("depth of format {}, expected millimetres or tenths", int(format)));
  }
  const auto row = static_cast<std::int64_t>(picture.width) * 2;
  if (picture.data == nullptr || picture.width <= 0 || picture.height <= 0 || picture.stride < row ||
      picture.dataSize < static_cast<std::int64_t>(picture.stride) * (picture.height - 1) + row) {
    throw Error(fmt::format("a picture of {}x{} pixels in {} bytes", picture.width, picture.height, picture.dataSize));
  }
  DepthImage depth(picture.width, picture.height);
  copy_rows(picture.data, static_cast<std::size_t>(picture.stride), depth);
  if (format == ONI_PIXEL_FORMAT_DEPTH_100_UM) {
    for (std::uint16_t& z : depth) z = static_cast<std::uint16_t>((z + 5) / 10);
  }
  if (mirrored) {
    for (int v = 0; v < depth.height(); ++v) std::reverse(depth.row(v), depth.row(v) + depth.width());
  }
  return depth;
}

NitePoint3f DepthView::direction(const Eigen::Vector3f& optical) const {
  return {mirrored ? -optical.x() : optical.x(), -optical.y(), optical.z()};
}

NitePoint3f DepthView::millimetres(const Eigen::Vector3f& metres) const { return direction(1000.F * metres); }

NiteQuaternion DepthView::turn(const Eigen::Quaternionf& optical) const {
  // The mirror image of a turn about an axis is the opposite turn about the mirrored axis: of its vector the other
  // components change their sign. Up for down is one mirror, left for right another.
  const float side = mirrored ? -1.F : 1.F;
  return {-optical.x(), side * optical.y(), -side * optical.z(), optical.w()};
}

Eigen::Vector2f DepthView::pixel_of(const NitePoint3f& point) const {
  return {float(width) / 2.F + focal_length(width, across_rad) * point.x / point.z,
          float(height) / 2.F - focal_length(height, down_rad) * point.y / point.z};
}

NitePoint3f DepthView::point_of(float u, float v, float z_mm) const {
  return {(u - float(width) / 2.F) / focal_length(width, across_rad) * z_mm,
          (float(height) / 2.F - v) / focal_length(height, down_rad) * z_mm, z_mm};
}

}  // namespace vesalius::nite2
