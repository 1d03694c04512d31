#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vesalius/forest.h"

namespace vesalius {

/// A tree laid out for walking many pixels at once (walk_kernels.h): the children of a node are neighbours, so that one
/// link serves both and the way to the right child is one step.
///
/// A node is `words_per_node()` words in a row. Node 0 is the root and node 1 is never reached; nodes 2k and 2k + 1 are
/// the children of the inner node whose link is k. A link of 0 marks a leaf, whose first word is its index. Where
/// several nodes share a child each has a copy, so there are twice as many nodes as inner nodes in the tree, plus two.
struct PackedTree {
  /// Whether nodes take 4 words rather than 2, because offsets, thresholds or links need it.
  /// Of 2 words the first holds the offsets u1, v1, u2, v2 as bytes, 128 added, u1 lowest; the second the threshold in
  /// mm above `link_bits` bits of link. The 4 words are u1 and v1 as int16, u2 and v2, the threshold, and the link.
  bool wide = false;
  int link_bits = 0;
  int levels = 0;  ///< edges from the root to the deepest leaf
  std::vector<std::uint32_t> words;
  std::vector<TreeLeaf> leaves;  ///< as the tree's, unused slots with label 0: adding all four slots does no harm

  /// A cache line, so that a leaf's logits are in as few of them as can be.
  struct alignas(64) LogitLine {
    std::array<std::int8_t, 64> values{};
  };
  /// Logits of the leaves where they were learned jointly, each leaf's from a line's beginning on.
  std::vector<LogitLine> logits;
  std::size_t lines_per_leaf = 0;

  int words_per_node() const { return wide ? 4 : 2; }
  const std::int8_t* logits_of(std::size_t leaf) const { return logits[leaf * lines_per_leaf].values.data(); }
};

/// Lays out a tree, which must pass check(Forest). Thresholds beyond what the convention's clipping lets a feature
/// reach are brought to that range, which changes no walk. Throws Error for more than 2^26 nodes: byte offsets are 32
/// bits.
PackedTree pack(const Tree& tree, const FeatureConvention& convention);

}  // namespace vesalius
