#include "cli/commands.h"
#include "cli/satellites.h"

namespace vesalius::cli {

Satellite evaluate_satellite() { return {.name = "evaluate", .commands = {add_evaluate, add_compare}}; }

}  // namespace vesalius::cli
