#pragma once

#include <memory>
#include <string>

#include "commands/train/model_recipe.h"
#include "commands/train/train_cluster.h"
#include "commands/train/train_run.h"

namespace vesalius::cli {

/// Makes a whole model by a recipe: renders frames, grows trees and learns their leaves, fits context and judge. What
/// is done is kept in OUT.work and not done again: frames, trees, rounds of leaves and the samples of each set are
/// found there by the run that follows an interrupted one, and by one of a changed recipe whatever does not depend on
/// the change. The same recipe gives the same bytes, interrupted or not, for any number of threads.
class ModelMaker {
 public:
  struct Run {
    TrainRun train;  ///< its `out` is the model; the report is one of the forest
    AssetPlaces assets;
    SourceOptions camera;       ///< camera of backgrounds
    TrainClusterFlags cluster;  ///< grows the forest on an engine if it names one
    bool trial = false;         ///< whether a step may be left out where frames are too few for it
  };

  /// Opens what the recipe names. Throws Error for what cannot be opened.
  ModelMaker(Run run, ModelRecipe recipe);
  ~ModelMaker();

  /// Returns what is left to do and about how long it takes, a line each: some frames are measured, the rest is
  /// multiplication. Throws Error where memory or disk would not suffice.
  std::string estimate();
  /// Makes the model. Throws Error as estimate() and the steps do, and when the user interrupts.
  void make();

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace vesalius::cli
