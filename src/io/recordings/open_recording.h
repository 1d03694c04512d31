#pragma once

#include <memory>
#include <string>

#include "io/recordings/recording.h"

namespace vesalius {

/// Opens a recording by its first bytes: MCAP, a ROS 1 bag, a ROS 2 bag in SQLite, Matroska. Throws Error naming `path`
/// and what was expected.
std::unique_ptr<Recording> open_recording(const std::string& path);

}  // namespace vesalius
