#pragma once

#include <cstdint>
#include <vector>

#include "train/grow_options.h"
#include "vesalius/base/random.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// Offsets of the pairs that a node tries, column by column: du1, dv1, du2, dv2, each of `padded` values.
struct CandidateTable {
  static constexpr int kLanes = 16;  ///< columns are padded to a multiple of this

  int count = 0;
  int padded = 0;
  std::vector<std::int16_t> offsets;

  CandidateTable() = default;
  explicit CandidateTable(int candidates);
  void set(int index, const TreeNode& node);
  TreeNode node(int index) const;  ///< offsets only
};

/// `count` random pairs: directions uniform, distances as the options say. Equal for equal state of `random`.
CandidateTable draw_candidates(const FeatureConvention& convention, const SplitOptions& options, int count,
                               Random& random);

/// Block `block` (of kBlockCandidates) of what node `number` of a tree tries: of the shared list, or of its own.
/// Nodes are numbered as in a heap: root 1, children 2n and 2n + 1.
CandidateTable node_candidates(const FeatureConvention& convention, const GrowTreeOptions& options, int tree,
                               std::uint32_t number, int block);

/// How many such blocks there are.
int candidate_blocks(const SplitOptions& options);
/// How many candidates a block has.
int block_candidates(const SplitOptions& options, int block);

}  // namespace vesalius
