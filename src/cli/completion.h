#pragma once

#include <string>

namespace CLI {
class App;
}

namespace vesalius::cli {

/// Completion scripts made from the program's own commands and flags, for the program `app.get_name()`.
std::string bash_completion(const CLI::App& app);
std::string zsh_completion(const CLI::App& app);
std::string fish_completion(const CLI::App& app);

}  // namespace vesalius::cli
