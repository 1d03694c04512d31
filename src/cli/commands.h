#pragma once

namespace CLI {
class App;
}

namespace vesalius::cli {

// Each function adds a subcommand to the program. Its callback does the work and throws Error if that fails.

void add_detect(CLI::App& program);
void add_info(CLI::App& program);
void add_convert(CLI::App& program);
void add_export(CLI::App& program);
void add_bench(CLI::App& program);
void add_record(CLI::App& program);
void add_cameras(CLI::App& program);
void add_options(CLI::App& program);

// The following commands belong to satellites (console/satellites.h); a build that leaves out a satellite lacks its
// commands.
void add_view(CLI::App& program);
void add_ros2(CLI::App& program);

}  // namespace vesalius::cli
