#include "cli/program.h"

#include <CLI/CLI.hpp>
#include <string>

#include "cli/commands.h"
#include "console/satellites.h"

namespace vesalius::cli {

// CMake writes satellites.inc, which names the satellites of this build.
#define VESALIUS_SATELLITE(name) Satellite name##_satellite();
#include "satellites.inc"
#undef VESALIUS_SATELLITE

namespace {

std::vector<Satellite> satellites_of_this_build() {
  return {
#define VESALIUS_SATELLITE(name) name##_satellite(),
#include "satellites.inc"
#undef VESALIUS_SATELLITE
  };
}

/// Refuses empty values of flags: they come from unset shell variables rather than from an intention.
void refuse_empty_values(CLI::App& program) {
  const auto check = [](const std::string& value) { return value.empty() ? "expected a value, found none" : ""; };
  for (CLI::App* command : program.get_subcommands({})) {
    for (CLI::Option* option : command->get_options()) {
      if (option->get_items_expected_max() > 0) option->check(check);
    }
  }
}

}  // namespace

void describe_program(CLI::App& program) {
  use_satellites(satellites_of_this_build());
  program.name("vesalius");
  program.description(
      "Finds people in RGB-D frames: 3-D body parts and joints, a part label for every pixel, a mask per person.");
  program.set_version_flag("--version", "vesalius " VESALIUS_VERSION, "Print the version and end");
  program.get_option("--help")->description("Print this help and end");
  program.footer(R"(
Examples:
  vesalius detect frames/                                  what is found, a line per frame
  vesalius detect frames/ --json people.jsonl --out pictures/
  vesalius info data/models/default.forest                 what is in a model
  vesalius train --data train/ --out my.forest             a model of your own
  vesalius detect --help                                   everything about one command

Exit codes: 0 done, 1 failed, 2 wrong usage.)");
  program.require_subcommand(1);
  add_detect(program);
  add_info(program);
  add_convert(program);
  add_export(program);
  add_record(program);
  add_cameras(program);
  add_bench(program);
  for (const Satellite& satellite : satellites()) {
    for (const auto add : satellite.commands) add(program);
  }
  add_options(program);
  refuse_empty_values(program);
}

}  // namespace vesalius::cli
