#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "vesalius/frame_source.h"

namespace vesalius {

/// Opens the source of frames that `uri` names: a path, or a scheme with what it expects after the colon.
///   PATH              the scheme is chosen by what the path holds
///   folder:FOLDER     depth/*.png (rgb/ or color/ optional) and meta.json or camera_info.yaml, or depth PNG files
///   tum:FOLDER        the layout of the TUM RGB-D benchmark (depth.txt); "tum:walking:1000" gives a depth scale too
///   pcd:PATH          an organised PCD file or a folder of them
///   png:PATH          a 16-bit depth PNG or a folder of them
///   recording:PATH    an MCAP file, a ROS 1 or ROS 2 bag, a folder of rosbag2, Azure Kinect's .mkv
///   openni2:ID, freenect:ID, realsense:ID, orbbec:ID
///                     a camera that is plugged in, by its serial number; "openni2:" if there is one alone
/// With `start_s` the frames begin so many seconds after the source's first, and their number is not known. Throws
/// Error with the path and what was expected, UsageError for options that do not go with the source, and for a start
/// behind the last frame.
std::unique_ptr<FrameSource> open_source(const std::string& uri, const SourceOptions& options = {});

/// Returns whether `uri` names a camera that is plugged in, which makes a live source, without opening it.
bool is_camera(const std::string& uri);

/// Returns the path in `uri` without the scheme.
std::string path_of_source(const std::string& uri);

/// Returns a frame with copies of the caller's buffers. `depth_mm` has width x height values; `rgb` has three bytes for
/// each pixel, or is null. Strides are the bytes from one row to the next; 0 means that the rows follow each other
/// without gaps. Throws Error for an impossible camera or stride.
Frame make_frame(const Camera& camera, const std::uint16_t* depth_mm, std::size_t depth_stride,
                 const std::uint8_t* rgb = nullptr, std::size_t rgb_stride = 0);

}  // namespace vesalius
