#include "assets/assets.h"
#include "cli/commands.h"
#include "cli/satellites.h"
#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

/// Which packages are where `vesalius assets` puts them.
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
