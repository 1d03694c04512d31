#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "vesalius/forest.h"
#include "vesalius/forest/leaf_logits.h"

// The messages between the driver of a training and the shards of its samples, as plain structs of integers, and what
// they are about. training_protocol.h explains their order. What goes to other machines has `visit_fields`, which
// passes each field with its name to a visitor, or each pair of fields of two messages: reading, writing
// (cluster/message.h) and merging follow from it. `merge(all, other)` adds the reply of one more shard. Since numbers
// are integers, the result does not depend on the order of merging, unless a comment says otherwise. Every `merge`
// throws Error if the replies are about different nodes, classes or bins.
namespace vesalius {

namespace detail {
struct SeeFields {
  const SeeFields& operator()(const char* /*name*/, auto&... /*field*/) const { return *this; }
};
}  // namespace detail

/// Has `visit_fields`: visit("name", field)("name", field) ...
template <class T>
concept HasFields = requires(T& message) {
  T::visit_fields(detail::SeeFields(), message);
};

/// Adds all numbers.
template <HasFields Reply>
void merge(Reply& all, const Reply& other);

namespace detail {

/// Throws Error about shards that replied with other numbers of `what`.
void expect_alike(bool alike, const char* what);

template <class T>
void add(const char* /*what*/, T& all, const T& other) {
  if constexpr (std::is_arithmetic_v<T>) {
    all += other;
  } else {
    merge(all, other);
  }
}
template <class T>
void add(const char* what, std::vector<T>& all, const std::vector<T>& other) {
  expect_alike(all.size() == other.size(), what);
  for (std::size_t i = 0; i < all.size(); ++i) add(what, all[i], other[i]);
}

struct AddFields {
  const AddFields& operator()(const char* name, auto& all, const auto& other) const {
    add(name, all, other);
    return *this;
  }
};

}  // namespace detail

template <HasFields Reply>
void merge(Reply& all, const Reply& other) {
  Reply::visit_fields(detail::AddFields(), all, other);
}

/// Replies about several nodes merge node by node.
template <class Reply>
void merge(std::vector<Reply>& all, const std::vector<Reply>& other) {
  detail::add("nodes", all, other);
}

/// Number of candidates in a block. A node's histogram of so many stays in the second-level cache.
inline constexpr int kBlockCandidates = 64;
/// Largest number of samples that choose a node's split; counts of so many fit 16 bits.
inline constexpr int kMostCounted = 65535;
/// Replaces the index of a node for samples that have reached a leaf.
inline constexpr std::int32_t kSettled = -1;

/// Reply: the samples of each class, and the pixels of each class in the pictures from which they were drawn.
struct SampleCounts {
  std::vector<std::int64_t> samples;  ///< [class]
  std::vector<std::uint64_t> pixels;  ///< [class]

  static void visit_fields(auto&& visit, auto&... of) { visit("samples", of.samples...)("pixels", of.pixels...); }
};

/// A node whose split is to be chosen.
struct LevelNode {
  std::uint32_t number = 1;  ///< numbered as in a heap: root 1, children 2n and 2n + 1
  std::int64_t size = 0;     ///< number of samples in all shards
  std::int64_t counted = 0;  ///< number of evenly spaced samples that choose the split; at most kMostCounted

  /// Returns how many of the first `rank` samples are counted.
  std::int64_t counted_before(std::int64_t rank) const { return counted == size ? rank : rank * counted / size; }

  static void visit_fields(auto&& visit, auto&... of) {
    visit("number", of.number...)("size", of.size...)("counted", of.counted...);
  }
};

/// Request: the nodes of the next level.
struct Level {
  std::vector<std::int32_t> node_of_child;  ///< index in `nodes`, or kSettled; in the first level only for the root
  std::vector<LevelNode> nodes;
};

/// Nodes [begin, end) of a level.
struct NodeRange {
  std::int32_t begin = 0, end = 0;
  std::int32_t size() const { return end - begin; }
};

/// The smallest and largest value of each candidate in mm; low > high if there is no sample.
struct ValueRanges {
  std::vector<std::int16_t> low, high;  ///< [candidate]

  ValueRanges() = default;
  explicit ValueRanges(int candidates);
};
void merge(ValueRanges& all, const ValueRanges& other);

/// Reply: the classes and values of a node's counted samples, before they are counted in bins.
struct NodeValues {
  std::vector<std::int32_t> class_counts;  ///< [class]
  ValueRanges ranges;

  static void visit_fields(auto&& visit, auto&... of) {
    visit("class counts", of.class_counts...)("ranges", of.ranges...);
  }
};

/// Returns the number of bins for a node of so many counted samples, at most `most`; few samples do not distinguish
/// many bins.
int bins_for(std::int64_t samples, int most);

/// The mapping from values to bins: bin = (2 min(value - low, 32767) * factor) >> 16.
struct Binning {
  int bins = 0;
  std::vector<std::int16_t> low;      ///< [candidate]
  std::vector<std::uint16_t> factor;  ///< [candidate]

  Binning(const ValueRanges& ranges, int bins);
  int bin_of(int candidate, int value) const;
  /// Returns the largest value whose bin is not above `bin`.
  int last_value(int candidate, int bin) const;
};

/// The classes of a node's counted samples, renumbered without gaps. The numbers follow from the counts of all shards
/// together, so all shards use the same.
struct ClassIndex {
  std::vector<std::uint8_t> index;   ///< [class]; 0 for classes that the node lacks
  std::vector<std::int32_t> totals;  ///< [renumbered class]: number of counted samples

  /// `class_counts` are the merged `NodeValues::class_counts`.
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
  std::size_t classes = 0;  ///< number of renumbered classes
  std::vector<std::uint16_t> counts;

  SplitHistogram() = default;
  SplitHistogram(std::size_t classes, int bins);
  std::uint16_t at(std::size_t class_index, int bin, int candidate) const {
    return counts[(class_index * bins + bin) * kBlockCandidates + candidate];
  }
};
/// Throws Error also if a sum exceeds 16 bits.
void merge(SplitHistogram& all, const SplitHistogram& other);

/// The threshold between `bin` and the next one of a candidate. `score` is the sum of n log2 n over both sides and all
/// classes minus that of the sides, in units of EntropyTable; it is largest where most information is gained.
struct BinSplit {
  int candidate = -1;  ///< -1 if no threshold leaves enough samples on both sides
  int bin = 0;
  std::int32_t score = 0;
};

/// The best of a node's thresholds between bins.
struct BinChoice {
  BinSplit split;
  std::vector<std::int32_t> below;  ///< [renumbered class]: counted samples in the bins before `split.bin`
};

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

/// Request: the best split of a node so far. A later one for the same node replaces it.
struct NodeSplit {
  std::int32_t node = 0;
  std::int32_t candidate = 0;  ///< in the block at hand
  TreeNode split;              ///< offsets and threshold
};

/// Reply: the samples of each class at the children of each node of a level. The children of node n are 2n and 2n + 1.
struct ChildCounts {
  std::int32_t classes = 0;
  std::vector<std::int64_t> counts;  ///< [child * classes + class]

  std::size_t children() const { return classes > 0 ? counts.size() / classes : 0; }
  const std::int64_t* of(std::size_t child) const { return counts.data() + child * classes; }
};
void merge(ChildCounts& all, const ChildCounts& other);

/// The samples at each child in all shards before one. A sample's rank in its node counts from there. For each shard
/// this is an exclusive prefix sum of the replies of the shards before it.
using ChildSizes = std::vector<std::int64_t>;
ChildSizes child_sizes(const ChildCounts& counts);

/// Reply: the background that a forest takes for a body, by the parts' share.
struct HardCounts {
  std::int64_t background = 0;        ///< background samples from which the forest already learns
  std::vector<std::uint64_t> counts;  ///< [parts' share in 1/255 over all trees]: pixels of the pool above half

  static void visit_fields(auto&& visit, auto&... of) { visit("background", of.background...)("counts", of.counts...); }
};

/// Request: the pixels of the pool that become samples: all with a share above `above`, and the first `ties` with
/// exactly that share.
struct HardCut {
  std::uint32_t above = 0;
  std::uint64_t ties = 0;

  static void visit_fields(auto&& visit, auto&... of) { visit("above", of.above...)("ties", of.ties...); }
};
/// Returns the cut that takes the `most` worst pixels of all shards, and on a tie the earlier ones.
HardCut hard_cut(const HardCounts& all, std::uint64_t most);
/// Returns the part of `cut` for a shard that counted `own`, and subtracts its ties from `cut`, so that the next shard
/// gets the rest.
HardCut take_part(HardCut& cut, const HardCounts& own);

/// The heading of a sample of the background, or of a person whose heading is not known.
inline constexpr std::uint8_t kNoHeading = 255;
/// Headings that samples tell apart: eighths of a turn, the first faces the camera (base/body_heading.h).
inline constexpr int kHeadings = 8;

/// A pixel from which a forest learns.
struct TrainingSample {
  std::uint32_t frame = 0;            ///< index in the set's FrameStore
  std::int16_t u = 0, v = 0;          ///< pixel
  std::uint16_t depth_mm = 0;         ///< its reading, never 0
  std::uint8_t label = 0;             ///< class of the forest: body part, or part_count for the background
  std::uint8_t heading = kNoHeading;  ///< the person's, below kHeadings
};

/// A person of a frame that no tree learns from: samples [begin, end) of a list.
struct PersonSamples {
  std::uint8_t heading = 0;
  std::uint32_t begin = 0, end = 0;

  static void visit_fields(auto&& visit, auto&... of) {
    visit("heading", of.heading...)("begin", of.begin...)("end", of.end...);
  }
};

/// Entropies as integers, so that splits do not depend on the order of additions. The table gives 1024 n log2 n,
/// rounded, for n up to kMostCounted. Sums over the classes of a node stay below 2^31.
class EntropyTable {
 public:
  static constexpr double kUnitsPerBit = 1024.0;

  EntropyTable();
  std::int32_t operator()(std::int64_t n) const { return values_[n]; }
  const std::int32_t* data() const { return values_.data(); }

 private:
  std::vector<std::int32_t> values_;
};

// The messages of learning all leaves of a forest together (learn_leaves.h).

/// Reply: the samples of each class, and of each heading among those of parts.
struct LabelCounts {
  std::vector<std::int64_t> classes;   ///< [class]
  std::vector<std::int64_t> headings;  ///< [heading]

  static void visit_fields(auto&& visit, auto&... of) { visit("classes", of.classes...)("headings", of.headings...); }
};

/// Request: how much a sample counts, in 1/kUnit.
struct SampleWeights {
  static constexpr int kUnit = 64;
  static constexpr double kOne = double{kUnit} * kUnit;  ///< the weight of a sample that counts once
  std::vector<std::int32_t> of_class;                    ///< [class]
  std::vector<std::int32_t> of_heading;                  ///< [heading]; samples of parts without heading count kUnit

  /// Returns the weight of a sample in 1/(kUnit * kUnit).
  std::int32_t of(const TrainingSample& sample) const {
    return of_class[sample.label] * (sample.heading < of_heading.size() ? of_heading[sample.heading] : kUnit);
  }

  static void visit_fields(auto&& visit, auto&... of) {
    visit("of class", of.of_class...)("of heading", of.of_heading...);
  }
};

/// Reply: for each leaf of one tree the weights of its samples by class and by side and heading, in 1/(kUnit * kUnit).
struct LeafCounts {
  std::vector<std::int64_t> weights;  ///< [leaf][LogitLayout]

  static void visit_fields(auto&& visit, auto&... self) { visit("weights", self.weights...); }
};

/// The logits of all leaves in learning.
struct LeafLogits {
  static constexpr float kUnit = 1.F / 1024.F;  ///< unit of a stored number, in nats
  static constexpr std::size_t kLanes = 16;     ///< rows are padded to a multiple of so many numbers

  std::size_t stride = 0;                           ///< numbers of a leaf
  std::vector<std::vector<std::int16_t>> of_trees;  ///< [tree][leaf * stride + place in the LogitLayout]

  static void visit_fields(auto&& visit, auto&... of) { visit("stride", of.stride...)("of trees", of.of_trees...); }
};
inline std::size_t padded_size(const LogitLayout& layout) {
  return (static_cast<std::size_t>(layout.size()) + LeafLogits::kLanes - 1) / LeafLogits::kLanes * LeafLogits::kLanes;
}

/// Request: the gradient over one of the parts into which all frames are divided.
struct GradientTask {
  int portion = 0;   ///< frames whose number leaves this remainder
  int portions = 1;  ///< divided by this
  int shift = 0;     ///< gradients are counted in 2^-shift of a weight of 1
};

/// Reply: the gradient of the samples' log likelihood by every logit: their weights where it is the true one, minus
/// their weights times its share.
struct LeafGradient {
  std::vector<std::vector<std::int32_t>> of_trees;  ///< [tree][leaf * stride + place]
  double log_likelihood = 0.0;                      ///< sum over the samples, for progress only
  double weight = 0.0;                              ///< weight of all samples

  static void visit_fields(auto&& visit, auto&... of) {
    visit("of trees", of.of_trees...)("log likelihood", of.log_likelihood...)("weight", of.weight...);
  }
};

/// A person from whom the regression of headings is learned.
struct FacingSample {
  std::vector<float> features;  ///< FacingEvidence::features
  int heading = 0;              ///< the true one

  static void visit_fields(auto&& visit, auto&... of) { visit("features", of.features...)("heading", of.heading...); }
};

}  // namespace vesalius
