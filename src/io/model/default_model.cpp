#include "io/model/default_model.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "default.model";

}  // namespace

std::string folder_of_library(const void* symbol) {
  Dl_info found{};
  if (dladdr(symbol, &found) == 0 || found.dli_fname == nullptr) return {};
  std::error_code error;
  const fs::path library = fs::canonical(found.dli_fname, error);
  return error ? std::string() : library.parent_path().string();
}

std::vector<std::string> model_folders(const std::string& own_folder, const std::string& installed) {
  std::vector<std::string> folders;
  const char* chosen = std::getenv("VESALIUS_MODELS");
  if (chosen != nullptr && *chosen != '\0') folders.emplace_back(chosen);
  if (own_folder.empty()) return folders;
  folders.push_back((fs::path(own_folder) / "models").string());
  folders.push_back((fs::path(own_folder) / installed).lexically_normal().string());
  return folders;
}

std::string find_default_model(const std::vector<std::string>& folders, const std::string& context) {
  std::error_code ignored;
  for (const std::string& folder : folders) {
    const fs::path model = fs::path(folder) / kName;
    if (fs::is_regular_file(model, ignored)) return model.string();
  }
  throw Error(fmt::format("{}, and no {} in {}", context, kName, fmt::join(folders, ", ")));
}

}  // namespace vesalius
