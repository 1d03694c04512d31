#pragma once

namespace CLI {
class App;
}

namespace vesalius::cli {

// Each function adds a subcommand to the program. Its callback does the work and throws Error if that fails.

void add_train(CLI::App& program);
void add_evaluate(CLI::App& program);
void add_compare(CLI::App& program);

}  // namespace vesalius::cli
