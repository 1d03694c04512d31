#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/frame.h"

namespace vesalius::ros2 {

/// Which pixels become points.
enum class CloudExtent {
  people,  ///< those of people with depth, in one row
  frame    ///< all, in the picture's rows and columns; not-a-number where there is no depth
};

/// Returns a sensor_msgs/PointCloud2 as CDR with the fields x, y, z (float32, metres), rgb (float32, as PCL packs
/// colours; black where the frame has none), label and body (uint32): the part's number, 255 where there is none, and
/// the person's id, 0 where there is nobody. PCL's PointXYZRGBL takes it. `index` has for each pixel the place in `ids`
/// or kBackground, `parts` the part or kBackground; both have the frame's size.
std::string cloud_message(const Frame& frame, const Image<std::uint8_t>& index, const LabelImage& parts,
                          const std::vector<int>& ids, CloudExtent extent, std::int64_t time_ns,
                          std::string_view frame_id);

}  // namespace vesalius::ros2
