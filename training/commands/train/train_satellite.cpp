#include "commands/training_commands.h"
#include "console/satellites.h"
#include "io/files/options_file.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

Satellite train_satellite() {
  return {.name = "train", .commands = {add_train}, .default_options = [] {
            TrainOptions options;
            return options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
          }};
}

}  // namespace vesalius::cli
