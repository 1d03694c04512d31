#pragma once

#include <functional>
#include <string>
#include <vector>

#include "synth/generate.h"

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

/// The data that `vesalius synth` reads from files.
struct LoadedAssets {
  synth::BodiesAndMotions assets;
  std::string sum;                 ///< SHA-256 over everything that was read, on which frames depend
  std::vector<std::string> notes;  ///< remarks for the user, one line each
  /// The substitutes for missing packages that the recipe would have used, one line each. They are also in `notes`.
  std::vector<std::string> stand_ins;
};

/// The places of files.
struct AssetPlaces {
  std::string folder;      ///< the folder in which `vesalius assets` keeps packages; empty takes its default
  std::string motions;     ///< the user's own motions (.bvh, .amc with .asf), used instead; may be empty
  bool movements = false;  ///< whether movements are loaded besides poses, as clips need them
};

/// Loads the assets that `recipe` uses. If the recipe leaves a choice (body.kind auto, default share of captured
/// poses), the built-in body and sampled poses are substituted for missing packages. Throws Error naming a missing
/// package that the recipe requires, or a file that cannot be used.
LoadedAssets load_assets(const synth::Recipe& recipe, const AssetPlaces& places);

/// Returns a line that says how many captured poses there are of each posture, and how many of 10000 sampled ones.
std::string pose_counts(const synth::PoseOptions& options, const synth::BodiesAndMotions& assets);

/// Returns the recipe and the digest of its assets as text. Anyone with the same files gets the same frames from it.
std::string full_recipe(synth::Recipe recipe, const LoadedAssets& loaded);

}  // namespace vesalius::cli
