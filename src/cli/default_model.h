#pragma once

#include <string>
#include <vector>

namespace vesalius::cli {

/// Returns the folders where models of this program are looked for, the first one first: $VESALIUS_MODELS where that is
/// set, "models" beside the program (the build tree has a link there), and the installation's share/vesalius/models.
std::vector<std::string> model_folders();

/// Returns the path of the model that commands take without --model, default.forest in the first of these folders that
/// has it. Throws Error naming the folders where none has.
std::string default_model();

}  // namespace vesalius::cli
