#pragma once

#include <string>
#include <vector>

#include "commands/synth/synth_recipe.h"

namespace vesalius {

/// What is fitted, and to what.
struct FitTask {
  std::string what;                    ///< joints, parts, trust, stances or flesh
  std::vector<std::string> sources{};  ///< frames with their truth; for trust and stances recordings
  std::vector<std::string> models{};   ///< find the people in them, each for itself; one for trust and stances
  std::string joint_set{};             ///< joints: the only set to fit; empty: those of the truth
  std::string recipe{};                ///< flesh: whose bodies and poses are taken
  cli::AssetPlaces assets{};
  int step = 1;         ///< the first of every so many frames
  bool hidden = false;  ///< trust and stances: also people whom nobody sees
};

/// A file of data/bodies, or what tools/put_fitted.py puts into one.
struct FittedBodyFile {
  std::string toml;
  std::string told;  ///< how well it fits, lines for the user
};

/// Throws UsageError for models of different parts or too many of them, Error for sources that cannot be used and too
/// few people in them.
FittedBodyFile fit_body(const FitTask& fit);

}  // namespace vesalius
