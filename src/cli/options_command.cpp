#include <memory>

#include "cli/commands.h"
#include "cli/option_flags.h"
#include "cli/text_sink.h"
#include "io/options_file.h"
#include "synth/recipe.h"
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
      ->check(CLI::IsMember({"detect", "synth"}))
      ->capture_default_str();
  command->footer(R"(
What it prints is a file for `vesalius detect --options FILE` or `vesalius synth --recipe FILE`; each name is a flag
of that command as well.

Examples:
  vesalius options > mine.toml
  vesalius options synth > recipe.toml)");
  command->callback([which] { print(*which == "detect" ? defaults<DetectOptions>() : defaults<synth::Recipe>()); });
}

}  // namespace vesalius::cli
