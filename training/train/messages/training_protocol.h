#pragma once

// How a forest is trained on samples that lie in several places (section 4.2).
//
// Glossary
//   shard     some of the frames with the pixels drawn from them: a TrainingSet. Shards follow each other in the order
//             of the frames, so that each sample has one rank among the samples of all shards.
//   driver    the loop below (grow_forest.cpp, grow_tree.cpp). It chooses the splits from merged replies and never sees
//             a sample or a frame.
//   executor  carries the driver's requests to all shards and merges their replies. LocalExecutor does so within this
//             process; another one may send them to other machines, since requests and replies are plain structs.
//   node      of the tree being grown; a level is the nodes of one depth that are still to be split, in order.
//   rank      of a sample among those of its node in all shards. A node of more samples than `split_pixels` chooses its
//             split by evenly spaced ranks: its counted samples.
//   rows      values of eq. 1 of the counted samples of a group of nodes, for one block of candidates; held by shards.
//   group     nodes of a level whose rows fit `row_bytes`. A batch is nodes of a group that one request is about.
//
// The loop
//   for each round: first `hard_trees` trees that look for hard negatives, then the trees of the forest
//     for each tree, several at a time
//       sample_counts                      how many samples of each class there are, for the root and for leaves
//       while the level has nodes
//         open_level                       the shards move samples to the nodes of the level and give them ranks
//         for each group of nodes, for each block of candidates
//           evaluate                       rows of the counted samples
//           for each batch of nodes, several at a time
//             node_values                  class counts and ranges of values; from them bins and class numbers
//             histograms                   counted samples by class, candidate and bin; from them the best split
//                                          (best_bins)
//             values_in                    values beside that split; from them its threshold
//             set_splits                   the shards note the splits that gain more than those before
//         route                            samples by class at both children of each node; from them the next level
//     after the first round
//       count_hard_negatives               background that its trees take for a body, by how much they do
//       add_hard_negatives                 the worst of it becomes samples
//   for the leaves of all trees together (learn_leaves.h), if they are learned
//     label_counts                         how many samples of each class and heading there are; from them weights
//     for each tree: leaf_counts           weights by class and heading in each leaf, where the logits start
//     for each round: gradient             over one portion of the frames; every logit takes a step
//     facing_samples                       what the new leaves tell of held-out people; from them the headings'
//     regression
//
// Replies are integers and merge in any order to the same numbers, and all that depends on the order of samples is said
// in ranks. So the forest does not depend on how many shards there are, nor on how many threads each of them uses.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "train/messages/grow_options.h"
#include "train/messages/training_messages.h"
#include "vesalius/error.h"
#include "vesalius/forest.h"

namespace vesalius {

/// A training throws this error when it is asked to stop.
class Interrupted : public Error {
 public:
  using Error::Error;
};

/// The shards' state for one growing tree. All members throw Error if a shard cannot be asked. Calls come one at a
/// time, except that the four about batches may come from several threads at once for batches without common nodes.
class TreeExecutor {
 public:
  virtual ~TreeExecutor() = default;

  virtual SampleCounts sample_counts() = 0;
  /// Moves each sample to its node of `level`. The first rank of a shard follows from the child sizes of the shards
  /// before it (ChildSizes). The executor knows these from the last `route`, or for the first level from their numbers
  /// of samples.
  virtual void open_level(const Level& level) = 0;
  /// Computes the rows of a group of nodes for one block of candidates. Earlier rows are dropped.
  virtual void evaluate(NodeRange group, int block) = 0;

  // The following are about a batch, which is nodes of the last evaluated group.
  virtual std::vector<NodeValues> node_values(NodeRange batch) = 0;
  virtual std::vector<SplitHistogram> histograms(NodeRange batch, const std::vector<CountTask>& tasks) = 0;
  /// Returns the best threshold of each node between bins of the first `candidates` candidates, with at least `least`
  /// [node] samples on each side. Chosen from `histograms` unless the executor has a quicker way.
  virtual std::vector<BinChoice> best_bins(NodeRange batch, const std::vector<CountTask>& tasks,
                                           const std::vector<int>& least, int candidates, const EntropyTable& entropy);
  virtual std::vector<IntervalValues> values_in(const std::vector<ValueInterval>& intervals) = 0;
  virtual void set_splits(const std::vector<NodeSplit>& splits) = 0;

  /// Sends all samples of split nodes to a side and counts them. The counts of other nodes have no meaning.
  virtual ChildCounts route() = 0;
};

/// The shards' state while the leaves of a forest are learned together. Calls come one at a time. All members throw
/// Error if a shard cannot be asked.
class LeafExecutor {
 public:
  virtual ~LeafExecutor() = default;

  virtual LabelCounts label_counts() = 0;
  virtual void set_weights(const SampleWeights& weights) = 0;
  virtual LeafCounts leaf_counts(int tree) = 0;
  virtual LeafGradient gradient(const LeafLogits& logits, const GradientTask& task) = 0;
};

/// The progress of trees that are being grown, summed over all of them. It is only for display.
struct GrowProgress {
  std::atomic<std::uint64_t> evaluations{0};  ///< values of eq. 1
  std::atomic<std::uint64_t> nodes{0};
  std::atomic<std::uint64_t> settled{0};  ///< samples times levels done; a tree ends at samples times max_depth
  std::atomic<bool> stop{false};          ///< if set, Interrupted is thrown
};

/// All shards of a training.
class Executor {
 public:
  virtual ~Executor() = default;

  /// Takes a finished tree; any thread may call it.
  using TakeTree = std::function<void(int number, Tree tree)>;

  /// Grows the trees of these numbers for a forest without trees and passes them on in any order. Throws Interrupted
  /// when `progress` says stop.
  virtual void grow_trees(const Forest& forest, const GrowTreeOptions& options, const std::vector<int>& numbers,
                          GrowProgress& progress, const TakeTree& take) = 0;
  virtual HardCounts count_hard_negatives(const Forest& forest) = 0;
  /// Adds the pixels counted last as samples, in each shard its part of the ties (take_part). Returns their number.
  virtual std::size_t add_hard_negatives(const HardCut& cut) = 0;
  /// Begins to learn the leaves of the forest's trees. Nothing else may go on meanwhile.
  virtual std::unique_ptr<LeafExecutor> begin_leaves(const Forest& forest, const LogitLayout& layout) = 0;
  /// Returns the held-out people as a forest with logits sees them, in the order of their frames.
  virtual std::vector<FacingSample> facing_samples(const Forest& forest) = 0;
};

}  // namespace vesalius
