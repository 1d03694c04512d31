#pragma once

#include <memory>
#include <string>

#include "io/recordings/recording.h"

namespace vesalius {

/// Returns whether this build has libavformat, which `open_mkv` needs.
bool has_mkv();

/// Opens a recording of an Azure Kinect or Femto: Matroska with a track of depth (16 bits, big-endian), one of colour
/// (MJPEG, NV12, YUY2 or BGRA), one of accelerations, and calibration.json. Its packets are given as messages of ROS 2,
/// after those of the calibration: Image, CompressedImage, CameraInfo, TFMessage, Imu. Times are the device's. Throws
/// Error naming `path` and what was expected; the package that is missing where this build has no libavformat.
std::unique_ptr<Recording> open_mkv(const std::string& path);

}  // namespace vesalius
