#pragma once

#include <string>
#include <vector>

namespace vesalius {

/// Returns the folder of the shared library that `symbol` of the caller's lies in; empty if that cannot be found out.
std::string folder_of_library(const void* symbol);

/// Returns the folders in which a program or library looks for models, in order: $VESALIUS_MODELS if it is set,
/// "models" in its own folder, and `installed`, as seen from there. An empty `own_folder` is not known.
std::vector<std::string> model_folders(const std::string& own_folder, const std::string& installed);

/// Returns the path of default.model in the first of the folders that has it. Throws Error naming the folders if none
/// has it; the message begins with `context`.
std::string find_default_model(const std::vector<std::string>& folders, const std::string& context);

}  // namespace vesalius
