#include "commands/training_commands.h"
#include "console/satellites.h"

namespace vesalius::cli {

Satellite evaluate_satellite() { return {.name = "evaluate", .commands = {add_evaluate, add_compare}}; }

}  // namespace vesalius::cli
