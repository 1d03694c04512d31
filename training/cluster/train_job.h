#pragma once

// What the map and reduce tasks of one job are told: a file of the store, written by the driver (docs/formats.md). It
// holds everything that a task needs besides the shards' sets, so tasks keep no state and any of them can be run again.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "train/grow_forest.h"
#include "train/growing_tree.h"
#include "train/messages/training_messages.h"
#include "vesalius/forest.h"

namespace vesalius {

/// What a job does. In the first column is what a line of its input names.
enum class JobKind : std::uint8_t {
  kPrepare,     ///< shard: draws its samples and writes its set
  kCount,       ///< shard: samples at the children of large nodes; reduced to sums and to the ranks of each shard
  kRows,        ///< shard: values of the counted samples of all open nodes; reduced to the best split
  kSubtrees,    ///< subtree task: grows the trees below some nodes from all shards
  kHardCounts,  ///< shard: background that the forest takes for a body
  kHarden,      ///< shard: adds the worst of it to its set, under another name
  kLeafCounts,  ///< shard: weights in the leaves of all trees; reduced to sums
  kGradient,    ///< shard: gradient of all logits over a portion of the frames; reduced to sums
  kFacing,      ///< shard: held-out people as the forest sees them
};

/// One tree of a job of kCount or kRows.
struct TreeRequest {
  int number = 0;
  OpenTree open;
  std::vector<LevelNode> nodes;     ///< nodes of the level; empty for kCount
  std::vector<std::int32_t> large;  ///< for kCount the children to count; for kRows the nodes that have ranks
  /// For kRows: samples of each large node in all shards before one: [shard * large.size() + index in large].
  std::vector<std::int64_t> before;

  static void visit_fields(auto&& visit, auto&... of) {
    visit("number", of.number...)("open", of.open...)("nodes", of.nodes...)("large", of.large...)("before",
                                                                                                  of.before...);
  }
};

/// Returns which nodes of a level share a record of their rows: as many as a reducer can hold.
std::vector<NodeRange> row_groups(const std::vector<LevelNode>& nodes, const SplitOptions& options);

/// Nodes of one tree whose subtrees one task grows.
struct SubtreeRequest {
  std::int32_t tree = 0;                               ///< index among TrainJob::trees
  std::vector<std::int32_t> nodes;                     ///< nodes of its level
  std::vector<std::vector<std::int64_t>> counts = {};  ///< [node][class]: its samples

  static void visit_fields(auto&& visit, auto&... of) {
    visit("tree", of.tree...)("nodes", of.nodes...)("counts", of.counts...);
  }
};

struct TrainJob {
  JobKind kind = JobKind::kPrepare;
  std::string name;  ///< name of the job
  Forest forest;     ///< what is trained, with trees where the job needs them
  TrainOptions options;
  std::string source;                       ///< kPrepare: how frames are opened
  std::string sets;                         ///< folder of the shards' sets
  std::string new_sets;                     ///< where kPrepare and kHarden write them
  std::vector<std::uint64_t> first_frames;  ///< [shard] and behind the last one
  std::uint64_t background_frames = 0;      ///< frames of the shards that the driver prepared itself
  SampleCounts samples;                     ///< samples of all shards
  std::vector<TreeRequest> trees;
  std::vector<SubtreeRequest> subtrees;
  std::vector<HardCut> cuts;  ///< kHarden: [shard]
  SampleWeights weights;
  LeafLogits logits;
  GradientTask gradient;

  std::size_t shards() const { return first_frames.size() - 1; }

  /// All but what is text elsewhere too: the forest's body, and the options.
  static void visit_fields(auto&& visit, auto&... of) {
    visit("kind", of.kind...)("name", of.name...)("forest", of.forest...)("source", of.source...)("sets", of.sets...)(
        "new sets", of.new_sets...)("first frames", of.first_frames...)("background frames", of.background_frames...)(
        "samples", of.samples...)("trees", of.trees...)("subtrees", of.subtrees...)("cuts", of.cuts...)(
        "weights", of.weights...)("logits", of.logits...)("gradient", of.gradient...);
  }
};

std::string set_name(const std::string& sets, std::size_t shard);

std::string serialise(const TrainJob& job);
/// Throws Error naming `name` for bytes that are damaged or of another build of the program.
TrainJob parse_train_job(std::string_view bytes, const std::string& name);

/// Where a job lies in the store, and where its result does.
std::string job_folder(const std::string& name);
std::string job_file(const std::string& name);

}  // namespace vesalius
