#pragma once

#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace vesalius::cli {

/// A part of the program that a build may leave out: VESALIUS_SYNTH, _TRAIN, _EVAL, _ASSETS of CMakeLists.txt.
struct Satellite {
  std::string name;
  std::vector<void (*)(CLI::App&)> commands;  ///< each adds a subcommand
  /// Returns the TOML text that `vesalius options NAME` prints; null where the satellite has no options.
  std::string (*default_options)() = nullptr;
  /// Returns what `vesalius info` says of it, as names and values; null: nothing but that it is there.
  std::vector<std::pair<std::string, std::string>> (*facts)() = nullptr;
};

/// Returns the satellites of this build.
std::vector<Satellite> satellites();

/// Returns the names of all satellites that a build can have.
std::vector<std::string> satellite_names();

}  // namespace vesalius::cli
