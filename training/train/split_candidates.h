#pragma once

#include <cstdint>
#include <vector>

#include "train/messages/grow_options.h"
#include "vesalius/base/random.h"
#include "vesalius/forest.h"

namespace vesalius {

/// The offsets of the pairs that a node tries, by columns: du1, dv1, du2, dv2. Each column has `padded` values.
struct CandidateTable {
  static constexpr int kLanes = 16;  ///< columns are padded to a multiple of this

  int count = 0;
  int padded = 0;
  std::vector<std::int16_t> offsets;

  CandidateTable() = default;
  explicit CandidateTable(int candidates);
  void set(int index, const TreeNode& node);
  TreeNode node(int index) const;  ///< a node with offsets only
};

/// Returns `count` random pairs with uniform directions and with distances as the options say. Equal states of `random`
/// give equal pairs.
CandidateTable draw_candidates(const FeatureConvention& convention, const SplitOptions& options, int count,
                               Random& random);

/// Returns block `block` (of kBlockCandidates) of the candidates of node `number` of a tree, from the shared list or
/// the node's own. Nodes are numbered as in a heap: root 1, children 2n and 2n + 1.
CandidateTable node_candidates(const FeatureConvention& convention, const GrowTreeOptions& options, int tree,
                               std::uint32_t number, int block);

/// Returns the number of such blocks.
int candidate_blocks(const SplitOptions& options);
/// Returns the number of candidates in a block.
int block_candidates(const SplitOptions& options, int block);

}  // namespace vesalius
