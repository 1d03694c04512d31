#pragma once

// What the driver of training and the shards of its samples tell each other, as plain structs of integers;
// training_protocol.h says in which order. Each reply of a shard merges with those of the others: `merge(all, other)`
// adds the reply of one more shard. Integers make the result independent of the order of merging, except where a
// comment says otherwise. All `merge` throw Error for replies that are not about the same nodes, classes or bins.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Candidates that one block has: as many as keep a node's histogram in the second-level cache.
inline constexpr int kBlockCandidates = 64;
/// Most samples of a node that choose its split: their counts fit 16 bits.
inline constexpr int kMostCounted = 65535;
/// In place of the index of a node: the samples have reached a leaf.
inline constexpr std::int32_t kSettled = -1;

/// Reply: samples to learn from, by class, and the pixels of each class in the pictures that they were drawn from.
struct SampleCounts {
  std::vector<std::int64_t> samples;  ///< [class]
  std::vector<std::uint64_t> pixels;  ///< [class]
};
void merge(SampleCounts& all, const SampleCounts& other);

/// A node whose split is to be chosen.
struct LevelNode {
  std::uint32_t number = 1;  ///< as in a heap: root 1, children 2n and 2n + 1
  std::int64_t size = 0;     ///< samples of all shards
  std::int64_t counted = 0;  ///< how many of them choose the split, evenly spaced; at most kMostCounted
};

/// Request: the nodes of the next level.
struct Level {
  std::vector<std::int32_t> node_of_child;  ///< index in `nodes`, or kSettled; for the first level of the root alone
  std::vector<LevelNode> nodes;
};

/// Nodes [begin, end) of a level.
struct NodeRange {
  std::int32_t begin = 0, end = 0;
  std::int32_t size() const { return end - begin; }
};

/// Smallest and largest value of each candidate, mm; low > high where there is no sample.
struct ValueRanges {
  std::vector<std::int16_t> low, high;  ///< [candidate]

  ValueRanges() = default;
  explicit ValueRanges(int candidates);
};
void merge(ValueRanges& all, const ValueRanges& other);

/// Reply: what one node's counted samples are, before they are counted in bins.
struct NodeValues {
  std::vector<std::int32_t> class_counts;  ///< [class]
  ValueRanges ranges;
};
void merge(NodeValues& all, const NodeValues& other);

/// Returns how many bins a node of so many counted samples uses, at most `most`: few samples do not tell many apart.
int bins_for(std::int64_t samples, int most);

/// How values become bins: bin = (2 min(value - low, 32767) * factor) >> 16.
struct Binning {
  int bins = 0;
  std::vector<std::int16_t> low;      ///< [candidate]
  std::vector<std::uint16_t> factor;  ///< [candidate]

  Binning(const ValueRanges& ranges, int bins);
  int bin_of(int candidate, int value) const;
  /// Returns the largest value whose bin is not above `bin`.
  int last_value(int candidate, int bin) const;
};

/// Which classes the counted samples of a node have, renumbered without gaps. The numbers follow from the counts of all
/// shards together, so that all shards number alike.
struct ClassIndex {
  std::vector<std::uint8_t> index;   ///< [class]; 0 for those that the node lacks
  std::vector<std::int32_t> totals;  ///< [renumbered class]: samples counted

  /// Of the merged `NodeValues::class_counts`.
  explicit ClassIndex(std::span<const std::int32_t> class_counts);
  std::size_t size() const { return totals.size(); }
};

/// Request: count the samples of one node in bins.
struct CountTask {
  Binning binning;
  ClassIndex classes;
};

/// Reply: counts[(class * bins + bin) * kBlockCandidates + candidate] of the counted samples of one node.
struct SplitHistogram {
  int bins = 0;
  std::size_t classes = 0;  ///< renumbered
  std::vector<std::uint16_t> counts;

  SplitHistogram() = default;
  SplitHistogram(std::size_t classes, int bins);
  std::uint16_t at(std::size_t class_index, int bin, int candidate) const {
    return counts[(class_index * bins + bin) * kBlockCandidates + candidate];
  }
};
/// Throws Error also where a sum leaves 16 bits.
void merge(SplitHistogram& all, const SplitHistogram& other);

/// Request: the values in (above, last] of one candidate of one node.
struct ValueInterval {
  std::int32_t node = 0;
  std::int32_t candidate = 0;        ///< in the block at hand
  std::int32_t above = 0, last = 0;  ///< mm
};

struct LabelledValue {
  std::int16_t value = 0;  ///< mm
  std::uint8_t label = 0;  ///< class, not renumbered
};

/// Reply: the counted samples whose value lies in an interval, in any order.
struct IntervalValues {
  std::vector<LabelledValue> values;
};
void merge(IntervalValues& all, const IntervalValues& other);

/// Request: the split that is best so far for a node; for the same node a later one takes its place.
struct NodeSplit {
  std::int32_t node = 0;
  std::int32_t candidate = 0;  ///< in the block at hand
  TreeNode split;              ///< offsets and threshold
};

/// Reply: samples of each class at the children of each node of a level; those of node n are 2n and 2n + 1.
struct ChildCounts {
  std::int32_t classes = 0;
  std::vector<std::int64_t> counts;  ///< [child * classes + class]

  std::size_t children() const { return classes > 0 ? counts.size() / classes : 0; }
  const std::int64_t* of(std::size_t child) const { return counts.data() + child * classes; }
};
void merge(ChildCounts& all, const ChildCounts& other);

/// Samples at each child, of the shards before one: a sample's rank in its node counts from there. What each shard gets
/// with a level follows from what those before it replied: an exclusive prefix sum.
using ChildSizes = std::vector<std::int64_t>;
ChildSizes child_sizes(const ChildCounts& counts);
void merge(ChildSizes& all, const ChildSizes& other);

/// Reply: background that a forest takes for a body, by how much it does.
struct HardCounts {
  std::int64_t background = 0;        ///< samples of the background that are learned from already
  std::vector<std::uint64_t> counts;  ///< [share of the parts in 1/255 over all trees]: pixels of the pool above half
};
void merge(HardCounts& all, const HardCounts& other);

/// Request: which pixels of the pool become samples: all of a share above `above`, and of those of just that share the
/// first `ties`.
struct HardCut {
  std::uint32_t above = 0;
  std::uint64_t ties = 0;
};
/// The `most` worst of all shards, the earlier on a tie.
HardCut hard_cut(const HardCounts& all, std::uint64_t most);
/// What `cut` asks of a shard that counted `own`; takes its ties from `cut`, so that the next shard gets the rest.
HardCut take_part(HardCut& cut, const HardCounts& own);

namespace detail {
/// Throws Error naming `what` two shards do not agree about.
void expect_alike(bool alike, const char* what);
}  // namespace detail

/// Replies about several nodes merge node by node.
template <class Reply>
void merge(std::vector<Reply>& all, const std::vector<Reply>& other) {
  detail::expect_alike(all.size() == other.size(), "nodes");
  for (std::size_t i = 0; i < all.size(); ++i) merge(all[i], other[i]);
}

}  // namespace vesalius
