#pragma once

#include <memory>
#include <string>

#include "io/recordings/recording.h"

namespace vesalius {

/// Opens a ROS 2 bag in SQLite (.db3), its messages compressed one by one or not. Throws Error naming the file.
std::unique_ptr<Recording> open_sqlite(const std::string& path);

}  // namespace vesalius
