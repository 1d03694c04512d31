#include "console/satellites.h"

#include <algorithm>
#include <utility>

namespace vesalius::cli {
namespace {

std::vector<Satellite>& present_satellites() {
  static std::vector<Satellite> present;
  return present;
}

}  // namespace

void use_satellites(std::vector<Satellite> present) { present_satellites() = std::move(present); }

const std::vector<Satellite>& satellites() { return present_satellites(); }

std::string device_help(const std::string& what, const std::string& cards) {
  if (std::ranges::none_of(satellites(), &Satellite::has_kernels)) {
    return what + ": cpu; this build has no kernels for cards (docs/gpu.md)";
  }
  return what + ": cpu, " + cards +
         ", or auto, a card where one works and otherwise the processor. The result is the same";
}

std::vector<std::string> satellite_names() {
  return {"view", "ros2", "cluster", "synth", "train", "evaluate", "assets", "cuda"};
}

std::string absent_command(const std::string& command) {
  const std::vector<std::string> workshop{"train", "synth", "evaluate", "compare", "assets"};
  const bool here = std::ranges::any_of(satellites(), [&](const Satellite& s) { return s.name == command; });
  if (here) return "";
  std::string without;
  if (std::ranges::find(workshop, command) != workshop.end()) without = "training (VESALIUS_TRAINING=OFF)";
  if (command == "view") without = "the viewer (VESALIUS_VIEW=OFF, or no Boost)";
  if (command == "ros2") without = "Cyclone DDS";
  if (without.empty()) return "";
  return command + " is not in this build, which was made without " + without + "; ./dev build makes the whole program";
}

}  // namespace vesalius::cli
