#pragma once

// The messages by which tasks reply to the driver, besides those that merge (merge_records.h).

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cluster/message.h"
#include "train/growing_tree.h"
#include "train/messages/leaf_messages.h"
#include "train/messages/training_messages.h"

namespace vesalius {

/// Leaves whose numbers are in one message: what a reducer holds of a key.
inline constexpr std::size_t kLeafBlock = 2048;
/// Key of the likelihoods beside the gradients.
inline constexpr const char* kLikelihoodKey = "likelihood";

/// What is known of a shard's set.
struct PreparedShard {
  SampleCounts samples;
  LabelCounts labels;
  std::uint64_t frames = 0, bytes = 0, held_out = 0;
  std::uint64_t hard_negatives = 0;  ///< samples that were added

  static void visit_fields(auto&& visit, auto&... of) {
    visit("samples", of.samples...)("labels", of.labels...)("frames", of.frames...)("bytes", of.bytes...)(
        "held out", of.held_out...)("hard negatives", of.hard_negatives...);
  }
};

/// Values of the counted samples of neighbouring nodes for one block of candidates, in one shard; node by node.
struct GroupRows {
  std::vector<std::uint32_t> rows;   ///< [node]
  std::vector<std::uint8_t> labels;  ///< [row of the node]
  /// Values, [candidate * rows of the node + row of the node], mm. High bytes repeat, low ones hardly: zstd makes less
  /// of them when they lie apart.
  std::vector<std::uint8_t> low, high;

  std::int16_t value(std::size_t at) const { return static_cast<std::int16_t>(low[at] | high[at] << 8U); }

  static void visit_fields(auto&& visit, auto&... of) {
    visit("rows", of.rows...)("labels", of.labels...)("low", of.low...)("high", of.high...);
  }
};
/// Throws Error naming `name` unless there are `nodes` nodes and `candidates` values in a row.
void check(const GroupRows& group, std::size_t nodes, int candidates, const std::string& name);

/// The best split of a node among one block of candidates.
struct NodeReply {
  double gain = 0.0;  ///< bits per sample; 0 if there is none
  TreeNode split;
  std::vector<std::int64_t> children;  ///< [side * classes + class]: its counted samples

  static void visit_fields(auto&& visit, auto&... of) {
    visit("gain", of.gain...)("split", of.split...)("children", of.children...);
  }
};

/// Samples at the children of large nodes.
struct CountReply {
  std::vector<std::int64_t> totals;  ///< [child * classes + class], all shards
  std::vector<std::int64_t> before;  ///< [shard * children + child]: in all shards before that one

  static void visit_fields(auto&& visit, auto&... of) { visit("totals", of.totals...)("before", of.before...); }
};

/// How well leaves in learning do.
struct Likelihood {
  double log_likelihood = 0.0, weight = 0.0;  ///< as in LeafGradient

  static void visit_fields(auto&& visit, auto&... of) {
    visit("log likelihood", of.log_likelihood...)("weight", of.weight...);
  }
};

/// Returns the nodes of a subtree. Throws Error naming `name` as well if a child is beyond the last one.
std::vector<GrownNode> parse_grown_nodes(std::string_view message, const std::string& name);

/// Keys: numbers of fixed width, so that lines sort as numbers do.
std::string shard_key(std::size_t shard);
std::string tree_key(std::size_t tree);
std::string node_key(std::size_t tree, std::size_t node, std::size_t block);
/// Reads the numbers of a key. Throws Error naming `name` if there are not `count`.
std::vector<std::size_t> key_numbers(const std::string& key, std::size_t count, const std::string& name);

}  // namespace vesalius
