#pragma once

#include <string>

namespace CLI {
class App;
}

namespace vesalius::cli {

/// Returns a bash script that completes the commands and flags of the program `app.get_name()`.
std::string bash_completion(const CLI::App& app);

}  // namespace vesalius::cli
