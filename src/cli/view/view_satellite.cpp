#include "cli/commands.h"
#include "console/satellites.h"

namespace vesalius::cli {

Satellite view_satellite() { return {.name = "view", .commands = {add_view}}; }

}  // namespace vesalius::cli
