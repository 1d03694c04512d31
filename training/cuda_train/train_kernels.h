#pragma once

// What the kernels of training (train_kernels.cuh) are told: one shard's part in growing a tree (train/tree_shard.h)
// and in learning leaves (train/leaves/leaf_shard.h). All pointers are to the device's memory. Every kernel has a
// thread for each of what it counts, unless it says otherwise.

#include <cstdint>
#include <vector>

#include "cuda/kernel_call.h"

namespace vesalius::gpu {

/// A frame among the packed tiles of all (train/samples/depth_tiles.h).
struct FrameInfo {
  std::uint64_t word = 0;  ///< its first
  std::int32_t width = 0, height = 0;
  double unit_u = 0.0, unit_v = 0.0;  ///< OffsetScaler
};

struct TiledFrames {
  const std::uint32_t* words = nullptr;
  const FrameInfo* frames = nullptr;
  std::uint32_t first = 0;  ///< number of the first of them among the frames that samples name
  std::int32_t hole_mm = 0, outside_mm = 0, clip_mm = 0;  ///< FeatureConvention
};

/// A TrainingSample as it lies in memory.
struct SamplePixel {
  std::uint32_t frame = 0;
  std::int16_t u = 0, v = 0;
  std::uint16_t depth_mm = 0;
  std::uint8_t label = 0, heading = 0;
};

struct alignas(8) SampleScale {
  std::int32_t u = 0, v = 0;
};

/// All samples of a shard, ordered by frame.
struct Samples {
  const SamplePixel* pixels = nullptr;
  const SampleScale* scales = nullptr;
  std::uint32_t count = 0;
};

/// Finds the scale of every sample.
struct ScaleArguments {
  static constexpr const char* kName = "scale";
  TiledFrames frames;
  Samples samples;
  SampleScale* scales = nullptr;
};

/// Moves samples from children of the last level to nodes of this one; kSettled (-1) stays.
struct RelabelArguments {
  static constexpr const char* kName = "relabel";
  std::int32_t* node_of = nullptr;
  const std::int32_t* node_of_child = nullptr;
  std::uint32_t samples = 0;
};

/// A node of a group: where its samples begin in the order of nodes, and which of them are counted (LevelNode).
struct RowNode {
  std::int64_t first_rank = 0, size = 0, counted = 0;
  std::uint32_t begin = 0;
  std::uint32_t row_begin = 0;  ///< its first row in the group
};

/// Finds the sample of each row: `row_of` gets the row + 1, labels the sample's class. One thread for each row.
struct RowsArguments {
  static constexpr const char* kName = "rows";
  const RowNode* nodes = nullptr;
  std::int32_t node_count = 0;
  std::uint32_t rows = 0;
  const std::uint32_t* order = nullptr;  ///< samples, node after node
  Samples samples;
  std::uint32_t* row_of = nullptr;  ///< [sample]; 0 for none
  std::uint8_t* labels = nullptr;   ///< [row]
};

/// Computes eq. 1 of all candidates at the samples with a row. A block has `samples_in_block` samples after each other,
/// `padded` threads for each at a time.
struct EvaluateArguments {
  static constexpr const char* kName = "evaluate";
  TiledFrames frames;
  Samples samples;
  const std::uint32_t* row_of = nullptr;
  const std::int32_t* node_of = nullptr;
  std::int32_t group_begin = 0;
  const std::int16_t* offsets = nullptr;  ///< [node of the group]: a CandidateTable
  std::int32_t padded = 0;                ///< candidates, a multiple of 16 and at most 64
  std::int32_t samples_in_block = 0;
  std::int16_t* values = nullptr;  ///< [row][candidate]
};

/// Rows of one node, which a block works on.
struct RowChunk {
  std::uint32_t node = 0;  ///< among those that are asked about
  std::uint32_t first_row = 0;
  std::uint32_t rows = 0;
};

struct Rows {
  const RowChunk* chunks = nullptr;  ///< [block_x]
  const std::int16_t* values = nullptr;
  const std::uint8_t* labels = nullptr;
  std::int32_t padded = 0;
};

/// Finds class counts and ranges of values (NodeValues). `negated_low` and `high` were -32768, counts 0.
struct RangesArguments {
  static constexpr const char* kName = "ranges";
  Rows rows;
  std::int32_t classes = 0;
  std::int32_t* negated_low = nullptr;   ///< [node][candidate]: the smallest value, negated
  std::int32_t* high = nullptr;          ///< [node][candidate]
  std::int32_t* class_counts = nullptr;  ///< [node][class]
};

/// Sets numbers.
struct FillArguments {
  static constexpr const char* kName = "fill";
  std::int32_t* values = nullptr;
  std::int32_t value = 0;
  std::uint32_t count = 0;
};

/// How a node's rows are counted in bins (CountTask), and where.
struct CountNode {
  std::uint64_t first = 0;   ///< its first pair of counts
  std::uint32_t totals = 0;  ///< its first class in the list of all nodes' renumbered classes
  std::int32_t bins = 0;
  std::int32_t classes = 0;  ///< renumbered
  std::int32_t least = 0;    ///< samples on a side
};

struct Histograms {
  const CountNode* nodes = nullptr;
  std::uint32_t* counts = nullptr;  ///< counts of each node [class][bin][pair of candidates], the first in the low half
  std::int32_t padded = 0;
};

/// Counts rows by class, candidate and bin; `counts` were 0. blocks_y: eights of candidates.
struct CountArguments {
  static constexpr const char* kName = "count";
  Rows rows;
  Histograms histograms;
  const std::int16_t* low = nullptr;       ///< [node][candidate]
  const std::uint16_t* factor = nullptr;   ///< [node][candidate]
  const std::uint8_t* class_of = nullptr;  ///< [node][class]: renumbered
  std::int32_t classes = 0;
};

/// The best split of a node over its bins (BinSplit).
struct BestOfNode {
  std::int32_t candidate = -1, bin = 0, score = 0;
};

/// Finds the best split of each node, and how many samples of each class lie in bins below it. A block for each node,
/// 64 threads or more.
struct BestArguments {
  static constexpr const char* kName = "best";
  Histograms histograms;
  const std::int32_t* totals = nullptr;
  const std::int32_t* entropy = nullptr;  ///< EntropyTable
  std::int32_t candidates = 0;
  BestOfNode* best = nullptr;
  std::int32_t* below = nullptr;  ///< as `totals`
};

/// Values of a node's candidate in (above, last].
struct Interval {
  std::int32_t candidate = 0, above = 0, last = 0;
};

struct CollectedValue {
  std::uint32_t interval = 0;
  std::int16_t value = 0;
  std::uint8_t label = 0, unused = 0;
};

/// Lists the values in intervals, in any order. The chunks' nodes are intervals.
struct CollectArguments {
  static constexpr const char* kName = "collect";
  Rows rows;
  const Interval* intervals = nullptr;
  CollectedValue* found = nullptr;
  std::uint32_t* count = nullptr;
};

/// A test of eq. 1 as a TreeNode lies in memory.
struct PlainNode {
  std::int16_t du1 = 0, dv1 = 0, du2 = 0, dv2 = 0;
  std::int16_t threshold_mm = 0;
  std::uint16_t divided = 0;  ///< whether a level's nodes have a split
  std::int32_t left = 0, right = 0;
};

/// Sends every sample of a level to a child, those of nodes without a split to the left one, and counts them there.
struct RouteArguments {
  static constexpr const char* kName = "route";
  TiledFrames frames;
  Samples samples;
  const PlainNode* splits = nullptr;  ///< [node]
  std::int32_t* node_of = nullptr;    ///< becomes that of the child
  std::int32_t classes = 0;
  std::uint32_t* counts = nullptr;  ///< [child][class]
};

/// A node whose samples are to be moved behind each other, those of the left child first.
struct MoveNode {
  std::uint32_t begin = 0;            ///< in the order so far
  std::uint32_t level_begin = 0;      ///< among the samples of the level's nodes alone
  std::uint32_t left = 0, right = 0;  ///< where the children begin
  std::uint32_t right_before = 0;     ///< samples that go right in the nodes before
};

struct Moves {
  const MoveNode* nodes = nullptr;
  std::int32_t node_count = 0;
  std::uint32_t samples = 0;
  const std::uint32_t* order = nullptr;
  const std::int32_t* node_of = nullptr;
};

/// Samples of the level's nodes that a thread takes.
inline constexpr unsigned kMoveRun = 8;

/// Counts in each block how many samples go right. A thread for each kMoveRun samples.
struct CountRightArguments {
  static constexpr const char* kName = "count right";
  Moves moves;
  std::uint32_t* of_block = nullptr;
};

/// Moves the samples; their order within a child stays. A thread for each kMoveRun samples.
struct MoveArguments {
  static constexpr const char* kName = "move";
  Moves moves;
  const std::uint32_t* before_block = nullptr;  ///< samples of the blocks before that go right
  std::uint32_t* order = nullptr;
};

/// Finds the leaf that each sample reaches in a tree.
struct FindLeavesArguments {
  static constexpr const char* kName = "find leaves";
  TiledFrames frames;
  Samples samples;
  const PlainNode* nodes = nullptr;
  std::int32_t node_count = 0;
  std::uint32_t* leaves = nullptr;
};

/// What samples weigh, and what logits a leaf has (LogitLayout, SampleWeights).
struct LeafLabels {
  const std::int32_t* of_class = nullptr;
  const std::int32_t* of_heading = nullptr;
  const std::uint8_t* groups = nullptr;  ///< [place]: as LogitArguments
  std::int32_t parts = 0, classes = 0, headings = 0, places = 0;
  std::int32_t weighted_headings = 0;  ///< those that `of_heading` has
};

/// Adds up the weights of each leaf's samples by class and by side and heading.
struct LeafWeightsArguments {
  static constexpr const char* kName = "leaf weights";
  Samples samples;
  LeafLabels labels;
  const std::uint32_t* leaves = nullptr;
  std::uint64_t* weights = nullptr;  ///< [leaf][place]
};

/// Adds up the gradients of the samples of one portion of the frames. A block has `samples_in_block` samples with
/// kLogitLanes threads each.
struct GradientArguments {
  static constexpr const char* kName = "gradient";
  Samples samples;
  LeafLabels labels;
  const std::uint32_t* leaves = nullptr;      ///< [tree][sample]
  const std::uint32_t* first_leaf = nullptr;  ///< [tree]
  const std::int16_t* logits = nullptr;       ///< [leaf][stride]
  std::int32_t* gradients = nullptr;          ///< [leaf][stride]
  std::int32_t trees = 0, stride = 0;
  float unit = 0.F, scale = 0.F;
  std::uint32_t portion = 0, portions = 1, first_frame = 0;
  std::int32_t samples_in_block = 0;
  std::uint64_t* likelihood = nullptr;  ///< in 1/4096 of a weight, two's complement
  std::uint64_t* weight = nullptr;
};

/// All kernels of training.
using TrainKernels =
    KernelList<ScaleArguments, RelabelArguments, RowsArguments, EvaluateArguments, RangesArguments, FillArguments,
               CountArguments, BestArguments, CollectArguments, RouteArguments, CountRightArguments, MoveArguments,
               FindLeavesArguments, LeafWeightsArguments, GradientArguments>;

/// What a block has room for in shared memory.
inline constexpr unsigned kSharedCounts = 4096;
inline constexpr unsigned kMostCandidates = 64;  ///< most candidates of a block (kBlockCandidates)
inline constexpr unsigned kMostBins = 32;
inline constexpr unsigned kMostClasses = 256;

/// Returns those that are compiled for cards: none in a build without nvcc.
std::vector<CardKernel> train_kernels_on_cards();

}  // namespace vesalius::gpu
