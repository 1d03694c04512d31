#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "io/files/data_file.h"
#include "io/recordings/recording.h"

namespace vesalius {

/// Opens an MCAP file. The data section alone is read, so that one without an end, as a process leaves it that was
/// killed, gives its whole messages. Throws Error naming the file.
std::unique_ptr<Recording> open_mcap(DataFile file);

/// First bytes of a ROS 1 bag.
inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";

/// Opens a ROS 1 bag of version 2.0, whatever its chunks are compressed with. Its index is not needed, so that a bag
/// that was never closed gives its whole messages. Throws Error naming the file.
std::unique_ptr<Recording> open_bag(DataFile file);

/// Opens a ROS 2 bag in SQLite (.db3), its messages compressed one by one or not. What a killed recorder left in the
/// log beside it (-wal) is read too; nothing is written. Throws Error naming the file.
std::unique_ptr<Recording> open_sqlite(DataFile file);

/// Returns whether this build has libavformat, which `open_mkv` needs.
bool has_mkv();

/// Opens a recording of an Azure Kinect or Femto: Matroska with a track of depth (16 bits, big-endian), one of colour
/// (MJPEG, NV12, YUY2 or BGRA), one of accelerations, and calibration.json. Its packets are given as messages of ROS 2,
/// after those of the calibration: Image, CompressedImage, CameraInfo, TFMessage, Imu. Times are the device's. Throws
/// Error naming `path` and what was expected; the package that is missing where this build has no libavformat.
std::unique_ptr<Recording> open_mkv(const std::string& path);

}  // namespace vesalius
