#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "console/text_sink.h"
#include "io/sensors/sensor_drivers.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

/// Returns the lines about one driver: whether this build has it, and the cameras that it sees.
std::vector<std::string> describe(const SensorDriver& driver) {
  const std::string scheme(driver.scheme);
  if (!driver.built) {
    return {fmt::format("{}: not in this build; install {} and build again ({})", scheme, driver.package, driver.what)};
  }
  std::vector<SensorInfo> cameras;
  try {
    cameras = driver.list();
  } catch (const Error& e) {
    return {e.what()};
  }
  if (cameras.empty()) return {fmt::format("{}: no camera plugged in ({})", scheme, driver.what)};
  std::vector<std::string> lines;
  for (const SensorInfo& camera : cameras) lines.push_back(fmt::format("{}:{}  {}", scheme, camera.id, camera.name));
  return lines;
}

}  // namespace

void add_cameras(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("cameras", "List the cameras that are plugged in, and the drivers of this build");
  command->footer(R"(
Examples:
  vesalius cameras)");
  command->callback([] {
    for (const SensorDriver& driver : sensor_drivers()) {
      for (const std::string& line : describe(driver)) print(one_line(line) + "\n");
    }
  });
}

}  // namespace vesalius::cli
