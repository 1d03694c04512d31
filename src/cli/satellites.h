#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/forest/make_labeller.h"

namespace CLI {
class App;
}
namespace vesalius {
class Executor;
class TrainingSet;
}  // namespace vesalius

namespace vesalius::cli {

/// Makes an executor over the sets, which grows at most so many trees at a time (train/local_executor.h).
using MakeExecutor = std::function<std::unique_ptr<Executor>(const std::vector<TrainingSet*>&, int trees_at_once)>;

/// A kind of device besides the processor that trains.
struct TrainerDevice {
  std::string name;
  /// Opens devices by their numbers, at least one. Throws DeviceError if one is not there.
  std::function<MakeExecutor(const std::vector<int>& numbers)> open;
};

/// A part of the program that a build may leave out, by VESALIUS_SYNTH, _TRAIN, _EVAL and _ASSETS of CMakeLists.txt.
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
  std::vector<TrainerDevice> trainers = {};
};

/// Returns the satellites of this build.
std::vector<Satellite> satellites();

/// Returns the names of all satellites that a build can have.
std::vector<std::string> satellite_names();

}  // namespace vesalius::cli
