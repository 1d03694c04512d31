#include "cli/default_model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "default.forest";

}  // namespace

std::vector<std::string> model_folders() {
  std::vector<std::string> folders;
  const char* chosen = std::getenv("VESALIUS_MODELS");
  if (chosen != nullptr && *chosen != '\0') folders.emplace_back(chosen);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return folders;
  folders.push_back((program.parent_path() / "models").string());
  folders.push_back((program.parent_path() / VESALIUS_MODELS_FROM_BIN).lexically_normal().string());
  return folders;
}

std::string default_model() {
  const std::vector<std::string> folders = model_folders();
  std::error_code ignored;
  for (const std::string& folder : folders) {
    const fs::path model = fs::path(folder) / kName;
    if (fs::is_regular_file(model, ignored)) return model.string();
  }
  throw Error(fmt::format("no --model given, and no {} in {}", kName, fmt::join(folders, ", ")));
}

}  // namespace vesalius::cli
