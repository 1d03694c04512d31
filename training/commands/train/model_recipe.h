#pragma once

#include <string>
#include <vector>

#include "synth/recipe.h"
#include "train/grow_forest.h"
#include "vesalius/base/options.h"

namespace vesalius::cli {

/// Frames that steps of a recipe learn from: rendered ones, or a dataset at hand.
struct FrameSet {
  std::string name;
  std::string data{};   ///< folder of labelled frames (`vesalius synth`); empty where they are rendered
  std::string looks{};  ///< names of [look.NAME] that apply, in order, with commas between
  int count = 0;        ///< frames to render; most frames to take of a dataset, 0: all
  int seed = 1;
  /// Options of rendered frames: the file that [synth] names, [synth], looks, the set's own options.
  synth::Recipe synth{};
};

/// The sets that boosted trees are fitted to.
struct FitSets {
  std::vector<std::string> frames;  ///< names; empty leaves the step out
  int step = 1;                     ///< the first of every so many frames
};

/// How a network is learned (training/network).
struct NetworkOptions {
  std::vector<std::string> frames, held_out;  ///< names of sets
  std::string config = "default";             ///< size of the network
  int views = 1'500'000;                      ///< pictures that it learns from
  int batch = 0;                              ///< pictures at once; 0: what suits the device
  float rate = 0.F;                           ///< learning rate; 0: what suits the batch
  int seed = 1;
  std::string init;                ///< file of weights that it begins with; empty for none
  std::string python = "python3";  ///< interpreter that has PyTorch
};

/// How a whole model is made (docs/retrain.md, "The recipe"). Paths are relative to the recipe's file.
struct ModelRecipe {
  std::string body;      ///< path of a body model; empty: the paper's body, or that of `model`
  std::string model;     ///< a model at hand whose forest is taken as it is; empty: one is grown
  bool network = false;  ///< whether a network labels pixels, and no forest
  NetworkOptions learn;  ///< if so, how it is learned
  std::vector<std::string> forest_frames, backgrounds;
  TrainOptions forest;
  FitSets context, judge;
  std::vector<FrameSet> sets;  ///< those that a step names, in the order of their names

  const FrameSet& set(const std::string& name) const;
};

/// Reads a recipe. Throws UsageError if the file is no recipe of a model, and Error with the line for an unknown option
/// or set (naming the most similar known one), a value out of range, and a set that no step names.
ModelRecipe read_model_recipe(const std::string& path);

/// Takes so large a share of each set's frames, at least two of each, and of a network's views.
void scale(ModelRecipe& recipe, double share);

}  // namespace vesalius::cli
