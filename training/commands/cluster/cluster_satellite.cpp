#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include "console/satellites.h"

namespace vesalius::cli {
namespace {

/// Returns where PATH has a program, or that it has not.
std::string place_of(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string file = folder + "/" + program;
    std::error_code ignored;
    if (!folder.empty() && std::filesystem::is_regular_file(file, ignored)) return file;
  }
  return "no " + program + " in PATH";
}

}  // namespace

Satellite cluster_satellite() {
  return {.name = "cluster", .commands = {}, .facts = [] {
            return std::vector<std::pair<std::string, std::string>>{{"Slurm", place_of("sbatch")},
                                                                    {"Hadoop", place_of("mapred")}};
          }};
}

}  // namespace vesalius::cli
