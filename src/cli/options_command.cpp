#include <CLI/CLI.hpp>
#include <map>
#include <memory>

#include "cli/commands.h"
#include "console/detector_flags.h"
#include "console/satellites.h"
#include "console/text_sink.h"
#include "io/files/options_file.h"

namespace vesalius::cli {
namespace {

std::string detector_defaults() {
  PeopleOptions options;
  return options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
}

/// Returns for each command with options the function that prints them.
std::map<std::string, std::string (*)()> all_defaults() {
  std::map<std::string, std::string (*)()> all{{"detect", detector_defaults}};
  for (const Satellite& satellite : satellites()) {
    if (satellite.default_options != nullptr) all[satellite.name] = satellite.default_options;
  }
  return all;
}

}  // namespace

void add_options(CLI::App& program) {
  CLI::App* command = program.add_subcommand("options", "Print every option of a command: help, unit, range, default");
  std::vector<std::string> names;
  for (const auto& [name, text] : all_defaults()) names.push_back(name);
  const auto which = std::make_shared<std::string>("detect");
  command->add_option("COMMAND", *which, "Whose options")
      ->check(CLI::IsMember(std::move(names)))
      ->capture_default_str();
  command->footer(R"(
The output is a file for `vesalius detect --options FILE`, `vesalius synth --recipe FILE` or
`vesalius train --options FILE`; each name is a flag of that command as well. Recipes of models (docs/retrain.md) have
those of synth and train in tables.

Examples:
  vesalius options > mine.toml
  vesalius options synth > recipe.toml)");
  command->callback([which] { print(all_defaults().at(*which)()); });
}

}  // namespace vesalius::cli
