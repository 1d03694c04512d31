#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "io/recordings/mcap_writer.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/person.h"

namespace vesalius {

/// Records frames, and the people found in them, into an MCAP file of standard ROS 2 messages:
///   /camera/depth/image, /camera/depth/camera_info     16UC1, millimetres, without loss; the camera
///   /camera/color/image                                rgb8, registered to depth; only of frames with colour
///   /camera/imu                                        Imu: gravity; from the first frame on that knows up
///   /people/body_index, /people/parts                  mono8: person and part of each pixel, 255 = neither
///   /people/markers                                    MarkerArray: links, parts, and scores or ids in 3-D
///   /people/json                                       String: the line of `vesalius detect --json`
/// All are in one coordinate frame, "camera_optical_frame". open_source reads depth, colour and up back as they were.
class FrameRecorder {
 public:
  /// Creates `path`. Frames without times get those of `rate` frames a second. Throws Error as McapWriter does.
  FrameRecorder(const std::string& path, double rate);

  /// Adds a frame. Throws Error naming the path if it cannot be written.
  void write(const Frame& frame);
  /// Adds the people of the frame that was added last. `json` is its line.
  /// The pictures hold their indices in `people`.
  void write_people(const Frame& frame, const TrackedFrame& people, const BodyModel& body, const std::string& json);
  /// Completes the file. Without this call it has all frames but those of the last second, and no summary.
  void close() { out_.close(); }

 private:
  std::uint16_t topic(std::optional<std::uint16_t>& known, const char* name, const char* type);

  McapWriter out_;
  double rate_;
  int frames_ = 0;
  std::int64_t time_ns_ = 0;  ///< time of the frame that was added last
  std::int64_t log_ns_ = 0;   ///< when it arrived, or the same
  std::optional<std::uint16_t> depth_, camera_, colour_, imu_, index_, parts_, markers_, json_;
};

}  // namespace vesalius
