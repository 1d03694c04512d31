#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "train/training_set.h"
#include "vesalius/base/options.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// How splits are proposed and judged.
struct SplitOptions {
  int candidates = 64;        ///< pairs of offsets a node tries
  int bins = 32;              ///< intervals between thresholds that a candidate's values are counted in; 2 to 32
  int split_pixels = 20000;   ///< most samples of a node that the choice of its split looks at
  float max_offset_m = 1.5F;  ///< furthest probe; at reference focal length 1
  bool half_normal = true;    ///< distance of a probe half-normal, a third of `max_offset_m` as sigma; else uniform
  float one_sided = 0.75F;    ///< share of the pairs with one probe at the pixel itself
  int shared_features =
      0;  ///< > 0: all nodes try this one list of pairs (the paper: 2000), not `candidates` of their own
  float min_gain = 1e-3F;  ///< bits a sample; a node whose best split gains less is a leaf
};

struct LeafOptions {
  int max_depth = 20;            ///< decisions on the way to the deepest leaf
  int min_samples = 30;          ///< fewest samples of a leaf
  float prior_correction = 0.F;  ///< 0: shares as sampled; 1: as in the pictures; between: a power between
  float part_balance = 0.5F;     ///< the same towards equal shares of all parts; the background keeps its own
};

struct GrowTreeOptions {
  int seed = 1;
  SplitOptions split;
  LeafOptions leaf;
  std::size_t row_bytes = std::size_t{512} << 20U;  ///< most values of features held at a time; trees are the same
};
void visit_options(const std::string& prefix, GrowTreeOptions& options, OptionVisitor& visitor);

/// What trees being grown have done so far, summed over all of them; for display only.
struct GrowProgress {
  std::atomic<std::uint64_t> evaluations{0};  ///< values of eq. 1
  std::atomic<std::uint64_t> nodes{0};
  std::atomic<std::uint64_t> settled{0};  ///< samples x levels done: a tree ends at samples x max_depth
  std::atomic<bool> stop{false};          ///< set it to have grow_tree throw Error("interrupted")
};

/// Grows one tree (section 4.2): each node takes the pair of offsets and the threshold of largest information gain over
/// `split_pixels` of its samples, then sends all of them to its children. Every node draws from a generator of its own,
/// seeded by (seed, tree, node), and counts are integers, so that the tree does not depend on the number of threads.
/// Subtrees grow in parallel. Branches whose leaves agree are pruned.
/// Throws Error for a set without samples, UsageError for an option out of range.
Tree grow_tree(const TrainingSet& set, const GrowTreeOptions& options, int tree, GrowProgress* progress = nullptr);

}  // namespace vesalius
