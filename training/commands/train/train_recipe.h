#pragma once

#include <string>
#include <vector>

#include "commands/train/model_recipe.h"
#include "commands/train/train_inputs.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// Returns how a forest is made, as the text that its model file carries: options as TOML, each source of frames with
/// its hash and, as comments, the recipe that makes it. Folders are not named, so the same data in another place gives
/// the same text. Equal texts give equal forests. `vesalius train --options` reads the text.
std::string train_recipe(TrainOptions options, const TrainInputs& inputs,
                         const std::vector<BackgroundFacts>& backgrounds);

/// Returns how a network is learned, likewise: options, the SHA-256 of the weights that it begins with, sets to learn
/// from. The machine may round otherwise, so equal texts mean networks that are as good.
std::string network_recipe(const NetworkOptions& options, const BodyModel& body, const std::vector<TrainInput>& inputs);

/// Returns how what a model has besides its forest is made, likewise: `what` ("judge of people") fitted to the first of
/// every `step` frames of the sources, with a model made by `before`.
std::string fitted_recipe(const std::string& what, int step, const std::vector<TrainInput>& inputs,
                          const std::string& before);

/// Returns the first line in which two such texts differ, as "`candidates = 50` before, now `candidates = 60`"; empty
/// if they are equal.
std::string first_difference(const std::string& before, const std::string& now);

}  // namespace vesalius::cli
