#pragma once

namespace CLI {
class App;
}

namespace vesalius::cli {

/// Adds `map`, `combine` and `reduce` to `vesalius train`: the tasks that engines run.
void add_train_tasks(CLI::App& train);

}  // namespace vesalius::cli
