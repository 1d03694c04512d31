#pragma once

#include <memory>
#include <string_view>

#include "io/files/data_file.h"
#include "io/recordings/recording.h"

namespace vesalius {

/// First bytes of a ROS 1 bag.
inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";

/// Opens a ROS 1 bag of version 2.0, whatever its chunks are compressed with. Its index is not needed, so that a bag
/// that was never closed gives its whole messages. Throws Error naming the file.
std::unique_ptr<Recording> open_bag(DataFile file);

}  // namespace vesalius
