#pragma once

#include <string>
#include <vector>

#include "cli/train/train_inputs.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// How a forest is made, as the text that its model file carries: options as TOML, each source of frames with its hash
/// and, as comments, the recipe that makes it. Says nothing of folders: the same data elsewhere gives the same text.
/// Equal texts, equal forests. `vesalius train --options` reads it.
std::string train_recipe(TrainOptions options, const TrainInputs& inputs,
                         const std::vector<BackgroundFacts>& backgrounds);

/// The first line in which two such texts differ, "`candidates = 50` before, now `candidates = 60`"; empty for equal
/// ones.
std::string first_difference(const std::string& before, const std::string& now);

}  // namespace vesalius::cli
