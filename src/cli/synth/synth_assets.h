#pragma once

#include <string>
#include <vector>

#include "synth/generate.h"

namespace vesalius::cli {

/// What `vesalius synth` takes from files.
struct LoadedAssets {
  synth::Assets assets;
  std::string sum;                 ///< SHA-256 over all that was read: frames depend on it
  std::vector<std::string> notes;  ///< what a user should know, one line each
  /// What stands in for a package that the recipe would have taken and that is not there, one line each; also in
  /// `notes`.
  std::vector<std::string> stand_ins;
};

/// Where files are looked for.
struct AssetPlaces {
  std::string folder;               ///< where `vesalius assets` puts MakeHuman's files and motions
  std::string motions;              ///< folder with motions of the user's (.bvh, .amc with .asf) instead; may be empty
  std::vector<std::string> models;  ///< furniture of the user's: OBJ, glTF
};

/// Loads what `recipe` wants of what is there. Where the recipe leaves a choice (body.kind auto, poses as by default)
/// the built-in body and sampled poses stand in for what is missing. Throws Error naming the package that a recipe asks
/// for and that is not there, or the file that cannot be used.
LoadedAssets load_assets(const synth::Recipe& recipe, const AssetPlaces& places);

}  // namespace vesalius::cli
