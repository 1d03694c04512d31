#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "io/recordings/recording.h"

namespace vesalius {

/// Returns whether a file that begins so may be one that `open_recording` opens.
bool is_recording(std::string_view first);

/// Opens a recording by its first bytes: MCAP, a ROS 1 bag, a ROS 2 bag in SQLite, these packed as a whole with zstd,
/// Matroska. Throws Error naming `path` and what was expected, and what it is instead where that is known.
std::unique_ptr<Recording> open_recording(const std::string& path);

}  // namespace vesalius
