#pragma once

#include <memory>
#include <string>

#include "vesalius/frame_source.h"

namespace vesalius {

/// Returns the frames of a recording (io/recordings): an MCAP file, a ROS 1 bag, a ROS 2 bag (.db3), or a folder as
/// rosbag2 writes it. Depth comes from the topic that `options` name, else from one registered to colour, else from the
/// first of depth; the camera from the calibration recorded beside it. A frame has the colour nearest in time, at most
/// 50 ms away, if that is registered to depth: both have one size and one coordinate frame. Frames are named by their
/// times. Throws Error naming the file and what was expected.
std::unique_ptr<FrameSource> open_recorded(const std::string& path, const SourceOptions& options);

}  // namespace vesalius
