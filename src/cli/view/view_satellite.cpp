#include "cli/commands.h"
#include "cli/satellites.h"

namespace vesalius::cli {

Satellite view_satellite() { return {.name = "view", .commands = {add_view}}; }

}  // namespace vesalius::cli
