#include <memory>

#include "cli/commands.h"
#include "cli/option_flags.h"
#include "cli/text_sink.h"
#include "io/options_file.h"

namespace vesalius::cli {

void add_options(CLI::App& program) {
  CLI::App* command = program.add_subcommand("options", "Print every detector option: help, unit, range, default");
  command->footer(R"(
What it prints is a file for `vesalius detect --options FILE`; each name is a flag as well.

Example:
  vesalius options > mine.toml)");
  command->callback([] {
    DetectOptions options;
    print(options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); }));
  });
}

}  // namespace vesalius::cli
