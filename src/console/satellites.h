#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vesalius/model.h"

namespace CLI {
class App;
}
namespace vesalius::cli {

/// A part of the program that a build may leave out, by VESALIUS_VIEW and VESALIUS_TRAINING of CMakeLists.txt.
struct Satellite {
  std::string name;
  std::vector<void (*)(CLI::App&)> commands;  ///< each function adds a subcommand
  /// This function returns the TOML text that `vesalius options NAME` prints; it is null if the satellite has no
  /// options.
  std::string (*default_options)() = nullptr;
  /// This function returns names and values that `vesalius info` prints; if it is null, only the satellite's name is
  /// printed.
  std::vector<std::pair<std::string, std::string>> (*facts)() = nullptr;
  std::vector<LabellerDevice> devices = {};  ///< that label pixels
  bool has_kernels = false;                  ///< whether the devices are built in, not only named in errors
};

/// Says which satellites this build has, before anything asks for them.
void use_satellites(std::vector<Satellite> present);

/// Returns the satellites of this build.
const std::vector<Satellite>& satellites();

/// Returns the help of --device, which names cards where this build has kernels for them. `cards`: e.g. "cuda or cuda:N
/// (a card)".
std::string device_help(const std::string& what, const std::string& cards);

/// Returns the names of all satellites that a build can have.
std::vector<std::string> satellite_names();

/// Returns what to say of a command that other builds have and this one lacks; empty for all other words.
std::string absent_command(const std::string& command);

}  // namespace vesalius::cli
