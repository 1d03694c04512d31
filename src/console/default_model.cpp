#include "console/default_model.h"

#include <filesystem>
#include <system_error>

#include "io/model/default_model.h"

namespace vesalius::cli {

std::vector<std::string> model_folders() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  return vesalius::model_folders(error ? "" : program.parent_path().string(), VESALIUS_MODELS_FROM_BIN);
}

std::string default_model() { return find_default_model(model_folders(), "no --model given"); }

}  // namespace vesalius::cli
