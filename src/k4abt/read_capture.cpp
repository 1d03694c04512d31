#include "k4abt/read_capture.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>

#include "io/files/image_bytes.h"
#include "io/recordings/colour_encodings.h"
#include "io/recordings/picture_message.h"
#include "k4abt/guard.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius::k4abt {
namespace {

LensCamera camera_of(const k4a_calibration_camera_t& calibration, const char* which) {
  if (calibration.intrinsics.type != K4A_CALIBRATION_LENS_DISTORTION_MODEL_BROWN_CONRADY) {
    throw UsageError(fmt::format("the calibration's {} has a lens of type {}, expected {} (Brown and Conrady)", which,
                                 int(calibration.intrinsics.type),
                                 int(K4A_CALIBRATION_LENS_DISTORTION_MODEL_BROWN_CONRADY)));
  }
  const auto& p = calibration.intrinsics.parameters.param;
  LensCamera found{{calibration.resolution_width, calibration.resolution_height, p.fx, p.fy, p.cx, p.cy}, {}};
  try {
    check(found.camera);
  } catch (const Error& e) {
    throw UsageError(fmt::format("the calibration's {}: {}", which, e.what()));
  }
  const auto lens = make_lens("rational_polynomial", {p.k1, p.k2, p.p1, p.p2, p.k3, p.k4, p.k5, p.k6});
  if (!lens || p.codx != 0.F || p.cody != 0.F) {
    throw UsageError(fmt::format("the calibration's {} has a distortion that no lens has", which));
  }
  found.lens = *lens;
  return found;
}

Eigen::Isometry3d transform_of(const k4a_calibration_extrinsics_t& extrinsics) {
  const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> rotation(extrinsics.rotation);
  const Eigen::Map<const Eigen::Vector3f> translation_mm(extrinsics.translation);
  return Eigen::Translation3d(translation_mm.cast<double>() * 1e-3) *
         Eigen::Quaterniond(Eigen::Matrix3d(rotation.cast<double>())).normalized();
}

/// Returns the colours of a picture of any format that cameras record. Throws Error for another, and a damaged one.
ColourImage decode(k4a_image_t image) {
  const k4a_image_format_t format = k4a().image_get_format(image);
  const auto* bytes = reinterpret_cast<const char*>(k4a().image_get_buffer(image));
  const std::string_view data(bytes, bytes != nullptr ? k4a().image_get_size(image) : 0);
  if (format == K4A_IMAGE_FORMAT_COLOR_MJPG) return decode_colour(data, "colour");
  PictureMessage picture;
  picture.width = k4a().image_get_width_pixels(image);
  picture.height = k4a().image_get_height_pixels(image);
  picture.row_bytes = static_cast<std::uint32_t>(k4a().image_get_stride_bytes(image));
  picture.data = data;
  if (format == K4A_IMAGE_FORMAT_COLOR_NV12) picture.encoding = "nv12";
  if (format == K4A_IMAGE_FORMAT_COLOR_YUY2) picture.encoding = "yuv422_yuy2";
  if (format == K4A_IMAGE_FORMAT_COLOR_BGRA32) picture.encoding = "bgra8";
  return decode_raw_colour(picture, "colour");
}

/// As the reader of recordings counts, so that the same recording gives the same times.
std::optional<double> time_of(k4a_image_t depth) {
  const std::uint64_t device_usec = k4a().image_get_device_timestamp_usec(depth);
  const std::uint64_t time_ns = device_usec != 0 ? device_usec * 1000 : k4a().image_get_system_timestamp_nsec(depth);
  return time_ns != 0 ? std::optional(double(time_ns) / 1e9) : std::nullopt;
}

}  // namespace

CaptureReader::CaptureReader(const k4a_calibration_t& calibration, std::optional<int> quarter_turns)
    : camera_(camera_of(calibration.depth_camera_calibration, "depth camera")), quarter_turns_(quarter_turns) {
  if (camera_.lens.model != LensModel::pinhole) {
    rectification_.emplace(camera_, camera_.camera);
    find_sources();
  }
  if (calibration.color_resolution == K4A_COLOR_RESOLUTION_OFF) return;
  try {
    registration_.emplace(camera_.camera, camera_of(calibration.color_camera_calibration, "colour camera"),
                          transform_of(calibration.extrinsics[K4A_CALIBRATION_TYPE_DEPTH][K4A_CALIBRATION_TYPE_COLOR]));
  } catch (const Error& e) {
    kGuard.say_once(std::string("colour is left out: ") + e.what());
  }
}

void CaptureReader::find_sources() {
  const Camera& camera = camera_.camera;
  sources_.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3f bent = camera.point(float(u), float(v), 1.F);
      const auto ray = undistort(camera_.lens, bent.head<2>().cast<double>());
      std::int32_t source = -1;
      if (ray) {
        const Eigen::Vector2f at = camera.pixel({float(ray->x()), float(ray->y()), 1.F});
        const long from_u = std::lround(at.x()), from_v = std::lround(at.y());
        const bool inside = from_u >= 0 && from_v >= 0 && from_u < camera.width && from_v < camera.height;
        if (inside) source = static_cast<std::int32_t>(from_v * camera.width + from_u);
      }
      sources_.push_back(source);
    }
  }
}

ImageReference CaptureReader::depth_of(k4a_capture_t capture) const {
  ImageReference depth(k4a().capture_get_depth_image(capture));
  if (!depth) throw UsageError("the capture has no depth");
  const Camera& camera = camera_.camera;
  const int width = k4a().image_get_width_pixels(depth.get()), height = k4a().image_get_height_pixels(depth.get());
  if (width != camera.width || height != camera.height) {
    throw UsageError(fmt::format("depth of {}x{} pixels, expected {}x{} as the calibration says", width, height,
                                 camera.width, camera.height));
  }
  const std::size_t row = static_cast<std::size_t>(width) * sizeof(std::uint16_t);
  const int stride = k4a().image_get_stride_bytes(depth.get());
  const bool has_rows = stride > 0 && static_cast<std::size_t>(stride) >= row &&
                        k4a().image_get_size(depth.get()) >=
                            static_cast<std::size_t>(stride) * static_cast<std::size_t>(height - 1) + row;
  if (k4a().image_get_format(depth.get()) != K4A_IMAGE_FORMAT_DEPTH16 || !has_rows ||
      k4a().image_get_buffer(depth.get()) == nullptr) {
    throw UsageError("the capture's depth has another format than DEPTH16, or too few bytes");
  }
  return depth;
}

ColourImage CaptureReader::colour_of(k4a_capture_t capture, const DepthImage& depth) const {
  const ImageReference image(k4a().capture_get_color_image(capture));
  if (!image) return {};
  try {
    ColourImage colour = decode(image.get());
    // Of the camera's own pixels, as k4a_transformation_color_image_to_depth_camera makes it.
    if (colour.same_size(depth)) return rectified(rectification_, std::move(colour));
    if (registration_ && registration_->fits(colour)) return (*registration_)(depth, colour);
  } catch (const Error& e) {
    kGuard.say_once(std::string("colour is left out: ") + e.what());
  }
  return {};
}

Frame CaptureReader::read(k4a_capture_t capture) const {
  const ImageReference image = depth_of(capture);
  Frame frame;
  frame.time_s = time_of(image.get());
  frame.camera = camera_.camera;
  frame.quarter_turns = quarter_turns_;
  frame.depth = DepthImage(camera_.camera.width, camera_.camera.height);
  copy_rows(k4a().image_get_buffer(image.get()), static_cast<std::size_t>(k4a().image_get_stride_bytes(image.get())),
            frame.depth);
  if (rectification_) frame.depth = rectification_->depth(frame.depth);
  frame.colour = colour_of(capture, frame.depth);
  return frame;
}

Image<std::uint8_t> CaptureReader::to_camera(const Image<std::uint8_t>& picture, std::uint8_t outside) const {
  if (sources_.empty()) return picture;
  Image<std::uint8_t> seen(picture.width(), picture.height(), outside);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (sources_[i] >= 0) seen.data()[i] = picture.data()[sources_[i]];
  }
  return seen;
}

}  // namespace vesalius::k4abt
