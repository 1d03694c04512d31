#pragma once

#include <string>
#include <vector>

#include "train/grow_tree.h"
#include "train/leaves/learn_leaves.h"
#include "train/messages/training_protocol.h"
#include "vesalius/base/options.h"
#include "vesalius/body_model.h"
#include "vesalius/forest.h"
#include "vesalius/frame.h"

namespace vesalius {

/// Everything that determines the forest of given frames.
struct TrainOptions {
  int trees = 8;
  int hard_trees = 2;         ///< trees of the first round, which finds hard negatives; 0 leaves it out
  float probe_clip_m = 0.5F;  ///< probes are clamped to the centre's depth +- this; 0 does not clamp
  SampleOptions sample;
  GrowTreeOptions grow;
  LeafLearningOptions leaves;
};
void visit_options(const std::string& prefix, TrainOptions& options, OptionVisitor& visitor);

/// Throws UsageError naming the first option that is out of its range.
void check(const TrainOptions& options);

/// Returns how features are read: offsets have steps of 5 mm, or longer ones if 127 steps would not reach the furthest
/// probe; holes and the world outside the picture are far; probes are clamped as the options say.
FeatureConvention training_convention(const TrainOptions& options);

/// First number of the first round's trees. It differs from the kept trees' numbers, so their nodes draw other tests.
inline constexpr int kFirstHardTree = 1000;

/// Trees that are grown together.
struct TreeRound {
  std::string name;  ///< "first round" or "forest"
  int first = 0;     ///< number of the first tree
  int trees = 0;
  int missing = 0;  ///< number of its trees that the store lacks
};

/// Receives reports of a training while it runs. The default ignores them.
class TrainObserver {
 public:
  virtual ~TrainObserver() = default;
  /// The missing trees of the round write to `progress` until `end_round`. Setting its `stop` ends the training with
  /// Interrupted.
  virtual void begin_round(const TreeRound& /*round*/, GrowProgress& /*progress*/) {}
  /// Called from any thread when a missing tree of the round is grown and saved.
  virtual void add_tree(const Tree& /*tree*/) {}
  /// Called at the end of the round, also if growing a tree throws.
  virtual void end_round() {}
  virtual void add_hard_negatives(std::size_t /*samples*/) {}
  /// Called after each round of learning leaves, of which there are `rounds`, with its number from 0 and the geometric
  /// mean of what the true classes get. Returns false to end the training with Interrupted.
  virtual bool end_leaf_round(int /*round*/, int /*rounds*/, double /*likelihood*/) { return true; }
};

/// Runs the loop of training_protocol.h: grows the first round, adds hard negatives, grows the forest, learns its
/// leaves together. What `store` has is not done again. Returns `forest`, which says what is trained, with its trees.
/// Throws Interrupted when the observer stops it, with all finished trees saved, and Error as grow_tree and the
/// executor do.
Forest train_forest(Executor& executor, Forest forest, const TrainOptions& options, TreeStore& store,
                    TrainObserver& observer);

/// Trains a forest on frames in memory, in one call. The forest is the same for any number of threads. Throws Error for
/// unusable frames, UsageError for an option out of range.
Forest grow_forest(const std::vector<LabelledFrame>& frames, const BodyModel& body, const TrainOptions& options);

}  // namespace vesalius
