#include "cli/commands.h"
#include "console/satellites.h"

namespace vesalius::cli {

Satellite ros2_satellite() { return {.name = "ros2", .commands = {add_ros2}}; }

}  // namespace vesalius::cli
