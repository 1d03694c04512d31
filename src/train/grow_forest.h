#pragma once

#include <string>
#include <vector>

#include "train/grow_tree.h"
#include "train/training_protocol.h"
#include "train/tree_store.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/options.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// All that decides what forest comes of given frames.
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

/// Returns how features are to be read: offsets in steps of 5 mm, or as long as 127 of them reach the furthest probe,
/// holes and the world outside the picture far, probes clamped as the options say.
FeatureConvention training_convention(const TrainOptions& options);

/// Numbers of the trees of the first round begin here, so that they draw other tests than those that are kept.
inline constexpr int kFirstHardTree = 1000;

/// Trees that are grown together.
struct TreeRound {
  std::string name;  ///< "first round" or "forest"
  int first = 0;     ///< number of the first tree
  int trees = 0;
  int missing = 0;  ///< how many of them the store lacks
};

/// What a training tells while it runs. The default says nothing.
class TrainObserver {
 public:
  virtual ~TrainObserver() = default;
  /// `progress` is what the missing trees of the round write to, until `end_round`; setting its `stop` ends the
  /// training with Interrupted.
  virtual void begin_round(const TreeRound& /*round*/, GrowProgress& /*progress*/) {}
  /// A missing tree of the round is grown and saved; from any thread.
  virtual void add_tree(const Tree& /*tree*/) {}
  /// Called also where growing a tree throws.
  virtual void end_round() {}
  virtual void add_hard_negatives(std::size_t /*samples*/) {}
};

/// Runs the loop of training_protocol.h: grows the first round, adds hard negatives, grows the forest. Trees that
/// `store` has are not grown again. At most `trees_at_once` trees grow at a time, each of which needs memory. Returns
/// `forest`, which says what is trained, with its trees. Throws Interrupted when the observer stops it, with all
/// finished trees saved, and Error as grow_tree and the executor do.
Forest train_forest(Executor& executor, Forest forest, const TrainOptions& options, TreeStore& store,
                    TrainObserver& observer, int trees_at_once = 1);

/// Adds as samples what `forest` takes for a body by mistake, as many as the options allow; returns how many.
std::size_t add_hard_negatives(Executor& executor, const Forest& forest, const SampleOptions& options);

/// Trains a forest on frames in memory, in one call. The forest is the same for any number of threads. Throws Error for
/// unusable frames, UsageError for an option out of range.
Forest grow_forest(const std::vector<LabelledFrame>& frames, const BodyModel& body, const TrainOptions& options);

}  // namespace vesalius
