#pragma once

#include <string>
#include <vector>

#include "train/grow_tree.h"
#include "train/training_set.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/options.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

struct TrainOptions {
  int trees = 8;
  int hard_trees = 2;         ///< trees of the first round, which finds hard negatives; 0 = no such round
  float probe_clip_m = 0.5F;  ///< probes are clamped to the centre's depth +- this; 0 = not
  SampleOptions sample;
  GrowTreeOptions grow;
};
void visit_options(const std::string& prefix, TrainOptions& options, OptionVisitor& visitor);

/// Throws UsageError naming the first option out of its range.
void check(const TrainOptions& options);

/// How features are to be read: offsets in steps of 5 mm, or as long as 127 of them reach the furthest probe, holes and
/// the world outside the picture far, probes clamped as the options say.
FeatureConvention training_convention(const TrainOptions& options);

/// Numbers of the trees of the first round begin here, so that they draw other tests than those that are kept.
inline constexpr int kFirstHardTree = 1000;

/// A forest of these trees for what `set` describes; `recipe` says how it was made.
Forest assemble_forest(const TrainingSet& set, std::vector<Tree> trees, std::string recipe);

/// Trains a forest in memory, in one call (section 4.2):
///   fill the set; grow trees of a first round; add as samples what they take for a body by mistake; grow the trees.
/// The same forest for any number of threads. Throws Error for unusable frames, UsageError for an option out of range.
Forest grow_forest(const std::vector<LabelledFrame>& frames, const BodyModel& body, const TrainOptions& options);

}  // namespace vesalius
