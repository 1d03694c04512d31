#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "cli/completion.h"
#include "console/text_sink.h"

namespace vesalius::cli {

void add_completion(CLI::App& program) {
  CLI::App* command = program.add_subcommand("completion", "Print a script that completes commands and flags");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "Shell to write for")->required()->check(CLI::IsMember({"bash"}));
  command->footer(R"(
An installed vesalius includes this script.

Example:
  source <(vesalius completion bash))");
  command->callback([shell, &program] { print(bash_completion(program)); });  // the option writes into `shell`
}

}  // namespace vesalius::cli
