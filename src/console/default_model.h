#pragma once

#include <string>
#include <vector>

namespace vesalius::cli {

/// Returns the folders in which the program looks for models, in order: $VESALIUS_MODELS if it is set, "models" beside
/// the program (the build tree has a link there), and share/vesalius/models of the installation.
std::vector<std::string> model_folders();

/// Returns the path of the model that commands use without --model: default.model in the first of these folders that
/// has it. Throws Error naming the folders if none has it.
std::string default_model();

/// The text of --help on --model, for commands that do so.
inline constexpr const char* kModelHelp = "Trained model; without it the default.model that comes with vesalius";

}  // namespace vesalius::cli
