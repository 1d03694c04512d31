#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/stored_depth.h"
#include "io/recordings/recording.h"
#include "vesalius/camera.h"
#include "vesalius/frame.h"

namespace vesalius {

/// A picture as a message has it: sensor_msgs/Image and CompressedImage, foxglove.RawImage and CompressedImage.
struct PictureMessage {
  std::int64_t time_ns = 0;  ///< time of the header; 0 = not given
  std::string frame;         ///< name of the camera's coordinate frame
  bool compressed = false;
  int width = 0, height = 0;    ///< 0 where it is compressed
  std::string encoding;         ///< e.g. "16UC1"; of a compressed one its format, e.g. "jpeg"
  std::uint32_t row_bytes = 0;  ///< from one row to the next
  bool big_endian = false;
  std::string_view data;  ///< into the message
};

/// A camera's calibration: sensor_msgs/CameraInfo, foxglove.CameraCalibration, that of a RealSense stream.
struct Calibration {
  std::string frame;
  int width = 0, height = 0;
  std::string model;                    ///< model of distortion, e.g. "plumb_bob"
  std::vector<double> distortion;       ///< all 0 or none = not distorted
  std::array<double, 9> matrix{};       ///< K, of the pictures as they are
  std::array<double, 9> rotation{};     ///< R, from these to the rectified ones; all 0 = not given
  std::array<double, 12> projection{};  ///< P, of the rectified ones
};

bool is_picture(const RecordedTopic& topic);
bool is_calibration(const RecordedTopic& topic);

/// Reads a message of a topic that is_picture. `name` must outlive the call. Throws Error naming `name`.
PictureMessage parse_picture(const RecordedTopic& topic, std::string_view message, const std::string& name);
/// Reads a message of a topic that is_calibration. Throws Error naming `name`.
Calibration parse_calibration(const RecordedTopic& topic, std::string_view message, const std::string& name);

/// Returns whether a picture is one of depth, by how it is encoded.
bool is_depth(const PictureMessage& picture);

/// Returns depth in millimetres, 0 = no reading. Throws Error naming `name` if the picture is not what it says.
DepthImage depth_of(const PictureMessage& picture, const StoredDepth& stored, const std::string& name);

/// Returns the colours of a picture: rgb8, bgr8, rgba8, bgra8, mono8, yuv422_yuy2, nv12, PNG or JPEG. Throws Error
/// naming `name`.
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
