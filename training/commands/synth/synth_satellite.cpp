#include "commands/training_commands.h"
#include "console/satellites.h"
#include "io/files/options_file.h"
#include "synth/recipe.h"
#include "synth/sensor/render.h"

namespace vesalius::cli {

Satellite synth_satellite() {
  return {.name = "synth",
          .commands = {add_synth},
          .default_options =
              [] {
                synth::Recipe recipe;
                return options_toml([&](OptionVisitor& visitor) { visit_options("", recipe, visitor); });
              },
          .facts =
              [] {
                return std::vector<std::pair<std::string, std::string>>{{"renderer", synth::renderer_version()}};
              }};
}

}  // namespace vesalius::cli
