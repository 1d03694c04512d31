#include "commands/training_commands.h"
#include "console/satellites.h"
#include "downloads/assets.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

/// Returns for each package whether it is in the folder of `vesalius assets`.
std::vector<std::pair<std::string, std::string>> packages() {
  std::vector<std::pair<std::string, std::string>> found;
  for (const AssetPackage& package : asset_packages()) {
    found.emplace_back(package.name, has_assets(package, default_assets_folder()) ? "present" : "absent");
  }
  return found;
}

}  // namespace

Satellite assets_satellite() { return {.name = "assets", .commands = {add_assets}, .facts = packages}; }

}  // namespace vesalius::cli
