#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "cli/completion.h"
#include "cli/text_sink.h"

namespace vesalius::cli {

void add_completion(CLI::App& program) {
  CLI::App* command = program.add_subcommand("completion", "Print a script that completes commands and flags");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "Whose language to write")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->footer(R"(
Examples:
  source <(vesalius completion bash)
  vesalius completion fish > ~/.config/fish/completions/vesalius.fish)");
  command->callback([shell, &program] {
    if (*shell == "bash") print(bash_completion(program));
    if (*shell == "zsh") print(zsh_completion(program));
    if (*shell == "fish") print(fish_completion(program));
  });
}

}  // namespace vesalius::cli
