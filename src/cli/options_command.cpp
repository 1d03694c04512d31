#include <memory>

#include "cli/commands.h"
#include "cli/option_flags.h"
#include "cli/text_sink.h"
#include "io/options_file.h"
#include "synth/recipe.h"
#include "train/grow_forest.h"
#include "vesalius/detect.h"

namespace vesalius::cli {
namespace {

template <class Options>
std::string defaults() {
  Options options;
  return options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
}

}  // namespace

void add_options(CLI::App& program) {
  CLI::App* command = program.add_subcommand("options", "Print every option of a command: help, unit, range, default");
  const auto which = std::make_shared<std::string>("detect");
  command->add_option("COMMAND", *which, "Whose options")
      ->check(CLI::IsMember({"detect", "synth", "train"}))
      ->capture_default_str();
  command->footer(R"(
What it prints is a file for `vesalius detect --options FILE`, `vesalius synth --recipe FILE` or
`vesalius train --options FILE`; each name is a flag of that command as well.

Examples:
  vesalius options > mine.toml
  vesalius options synth > recipe.toml)");
  command->callback([which] {
    if (*which == "detect") print(defaults<DetectOptions>());
    if (*which == "synth") print(defaults<synth::Recipe>());
    if (*which == "train") print(defaults<TrainOptions>());
  });
}

}  // namespace vesalius::cli
