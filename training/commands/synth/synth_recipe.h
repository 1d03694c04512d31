#pragma once

#include <functional>
#include <string>

#include "commands/synth/synth_assets.h"
#include "synth/recipe.h"

namespace vesalius::cli {

/// The sources of a recipe. Later ones override earlier ones: the defaults, the defaults of the mounting, the file,
/// `sensor`, `camera`, `change`.
struct RecipeRequest {
  std::string file{};                            ///< path of a TOML file; empty for none
  std::string sensor{};                          ///< name of a preset; empty for that of the file
  std::string camera{};                          ///< path of a file with intrinsics; empty for those of the preset
  std::function<void(synth::Recipe&)> change{};  ///< overrides options of the file; may be empty
};

/// Composes a recipe. Throws Error naming a file that cannot be used, and UsageError for options out of range.
synth::Recipe make_recipe(const RecipeRequest& request);

/// Returns the recipe and the digest of its assets as text. Anyone with the same files gets the same frames from it.
std::string full_recipe(synth::Recipe recipe, const LoadedAssets& loaded);

}  // namespace vesalius::cli
