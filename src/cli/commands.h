#pragma once

namespace CLI {
class App;
}

namespace vesalius::cli {

// Each adds its subcommand to the program, with a callback that does the work and throws Error where it cannot.

void add_detect(CLI::App& program);
void add_info(CLI::App& program);
void add_convert(CLI::App& program);
void add_bench(CLI::App& program);
void add_options(CLI::App& program);
void add_completion(CLI::App& program);

// These come with satellites.h and are missing from a build that leaves theirs out.
void add_synth(CLI::App& program);
void add_train(CLI::App& program);
void add_evaluate(CLI::App& program);
void add_compare(CLI::App& program);
void add_assets(CLI::App& program);

}  // namespace vesalius::cli
