#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/stored_depth.h"
#include "io/recordings/picture_message.h"
#include "io/recordings/recording.h"
#include "vesalius/camera.h"
#include "vesalius/frame.h"

namespace vesalius {

/// A camera's calibration: sensor_msgs/CameraInfo, foxglove.CameraCalibration, that of a RealSense or Orbbec stream.
struct Calibration {
  std::string frame;
  int width = 0, height = 0;            ///< of the pictures that the numbers below are for
  std::string model;                    ///< model of distortion, e.g. "plumb_bob"
  std::vector<double> distortion;       ///< all 0 or none = not distorted
  std::array<double, 9> matrix{};       ///< K, of the pictures as they are
  std::array<double, 9> rotation{};     ///< R, from these to the rectified ones; all 0 = not given
  std::array<double, 12> projection{};  ///< P, of the rectified ones
  int binning_x = 1, binning_y = 1;     ///< pixels that were made one, after the part below was cut out
  int roi_x = 0, roi_y = 0, roi_width = 0, roi_height = 0;  ///< part that is recorded; 0x0 = all
};

bool is_picture(const RecordedTopic& topic);
bool is_calibration(const RecordedTopic& topic);

/// Reads a message of a topic that is_picture. `name` must outlive the call. Throws Error naming `name`.
PictureMessage parse_picture(const RecordedTopic& topic, std::string_view message, const std::string& name);
/// Reads a message of a topic that is_calibration. Throws Error naming `name`.
Calibration parse_calibration(const RecordedTopic& topic, std::string_view message, const std::string& name);

/// Returns the calibration of pictures of that size that a camera records which is calibrated for others: a part of
/// them, pixels binned, or both sides a whole number of times smaller or larger, as filters that decimate leave it.
/// Returns nothing where the sizes do not go together.
std::optional<Calibration> scaled_to(const Calibration& calibration, int width, int height);

/// Returns whether a picture is one of depth, by how it is encoded.
bool is_depth(const PictureMessage& picture);

/// Returns depth in millimetres, 0 = no reading: 16 bits, a 16-bit PNG, compressedDepth, disparities, points. Throws
/// Error naming `name` if the picture is not what it says.
DepthImage depth_of(const PictureMessage& picture, const StoredDepth& stored, const std::string& name);

/// Returns the points of a picture of points, metres; NaN = no reading. Throws Error naming `name` if it has none.
Image<Eigen::Vector3f> points_of(const PictureMessage& picture, const std::string& name);

/// Returns the colours of a picture: those of colour_encodings.h, PNG or JPEG, of points. Throws Error naming `name`.
ColourImage colour_of(const PictureMessage& picture, const std::string& name);

/// Returns a sensor_msgs/Image of 16UC1, millimetres, as CDR.
std::string depth_message(const DepthImage& depth, std::int64_t time_ns, std::string_view frame);
/// Returns a sensor_msgs/Image of rgb8 as CDR.
std::string colour_message(const ColourImage& colour, std::int64_t time_ns, std::string_view frame);
/// Returns a sensor_msgs/Image of mono8 as CDR.
std::string grey_message(const Image<std::uint8_t>& grey, std::int64_t time_ns, std::string_view frame);
/// Returns a sensor_msgs/Image or CompressedImage as CDR.
std::string picture_message(const PictureMessage& picture);
/// Returns a sensor_msgs/CameraInfo as CDR.
std::string calibration_message(const Calibration& calibration, std::int64_t time_ns);
/// Returns a sensor_msgs/CameraInfo without distortion as CDR.
std::string calibration_message(const Camera& camera, std::int64_t time_ns, std::string_view frame);

}  // namespace vesalius
