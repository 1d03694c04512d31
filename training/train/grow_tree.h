#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "train/growing_tree.h"
#include "train/messages/grow_options.h"
#include "train/messages/training_protocol.h"
#include "train/samples/training_set.h"
#include "vesalius/forest.h"

namespace vesalius {

/// Grows tree number `tree`, which `shards` have begun with the same options, over all shards (section 4.2,
/// training_protocol.h): each node takes the pair of offsets and the threshold of largest information gain over
/// `split_pixels` of its samples, then sends all of them to its children. It grows level by level, and the nodes of a
/// level choose their splits in parallel. Every node draws from a generator of its own, seeded by (seed, tree, node),
/// and counts are integers, so that the tree depends neither on the number of threads nor on the number of shards.
/// Branches whose leaves agree are pruned. `forest` says what is trained: its body and how features are read. Throws
/// Error where there are no samples, UsageError for an option out of range.
Tree grow_tree(TreeExecutor& shards, const Forest& forest, const GrowTreeOptions& options, int tree,
               GrowProgress& progress);

/// Grows the trees below nodes of tree number `tree` whose samples the shards have moved there (LocalTree::walk_to);
/// `samples` are those of the whole training. Returns their nodes, the roots first. Otherwise as grow_tree.
std::vector<std::vector<GrownNode>> grow_subtrees(TreeExecutor& shards, const Forest& forest,
                                                  const GrowTreeOptions& options, int tree, const SampleCounts& samples,
                                                  std::span<const TreeRoot> roots, GrowProgress& progress);

/// Grows a tree on one set within this process.
Tree grow_tree(const TrainingSet& set, const GrowTreeOptions& options, int tree, GrowProgress* progress = nullptr);

}  // namespace vesalius
