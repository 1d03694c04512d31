#pragma once

#include <string>

#include "cli/option_flags.h"
#include "cli/synth/synth_assets.h"
#include "synth/recipe.h"

namespace vesalius::cli {

/// What a recipe is put together from. Later ones win: the defaults, those of the mounting, the file, `sensor`,
/// `camera`, the flags.
struct RecipeRequest {
  std::string file{};                                 ///< TOML; empty: none
  std::string sensor{};                               ///< preset; empty: the file's
  std::string camera{};                               ///< file with intrinsics; empty: the preset's
  const OptionFlags<synth::Recipe>* flags = nullptr;  ///< may be null
};

/// Throws Error naming the file that cannot be used, UsageError for options out of range.
synth::Recipe make_recipe(const RecipeRequest& request);

/// The recipe and what it was made with, as text: whoever has these files gets these frames.
std::string full_recipe(synth::Recipe recipe, const LoadedAssets& loaded);

}  // namespace vesalius::cli
