#pragma once

// Random trees and pictures for tests of what walks them.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/forest.h"
#include "vesalius/image.h"

namespace vesalius::test {

struct TreeKind {
  int nodes = 0;
  int max_depth = 20;
  int max_offset = 127;
  int max_threshold_mm = 2000;
  bool shared = false;  ///< whether some children have several parents
};

/// Returns a tree that is deep rather than complete. There are as many leaves as are needed to end its open branches.
inline Tree random_tree(Random& random, const TreeKind& kind) {
  const auto within = [&](int limit) {
    const int value = static_cast<int>(random.below(static_cast<std::uint32_t>(2 * limit + 1))) - limit;
    return static_cast<std::int16_t>(random.below(20) == 0 ? (value < 0 ? -limit : limit) : value);
  };
  struct Branch {
    std::size_t parent;
    bool right;
    int depth;
  };
  Tree tree;
  std::vector<Branch> open;
  const auto attach = [&](const Branch& branch, std::int32_t child) {
    (branch.right ? tree.nodes[branch.parent].right : tree.nodes[branch.parent].left) = child;
  };
  const auto end_in_leaf = [&](const Branch& branch) {
    attach(branch, ~static_cast<std::int32_t>(tree.leaves.size()));
    tree.leaves.emplace_back();
  };
  for (int n = 0; n < kind.nodes; ++n) {
    int depth = 0;
    if (n > 0) {
      if (open.empty()) break;
      const bool newest = random.below(10) < 6;
      const std::size_t i = newest ? open.size() - 1 : random.below(static_cast<std::uint32_t>(open.size()));
      const Branch branch = open[i];
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(i));
      attach(branch, n);
      depth = branch.depth;
    }
    const TreeNode node{within(kind.max_offset), within(kind.max_offset), within(kind.max_offset),
                        within(kind.max_offset), within(kind.max_threshold_mm)};
    tree.nodes.push_back(node);
    for (const bool right : {false, true}) {
      const Branch branch{tree.nodes.size() - 1, right, depth + 1};
      if (branch.depth < kind.max_depth) {
        open.push_back(branch);
      } else {
        end_in_leaf(branch);
      }
    }
  }
  for (const Branch& branch : open) end_in_leaf(branch);
  if (tree.leaves.empty()) tree.leaves.emplace_back();
  for (std::size_t n = 0; kind.shared && n + 2 < tree.nodes.size(); n += 5) {
    const auto later = static_cast<std::uint32_t>(tree.nodes.size() - n - 1);
    tree.nodes[n].right = static_cast<std::int32_t>(n + 1 + random.below(later));
  }
  return tree;
}

/// Returns holes, walls, noise, and the ends of the range.
inline DepthImage random_depth(Random& random, int width, int height) {
  DepthImage depth(width, height, 0);
  const std::uint16_t ends[] = {1, 2, 65535, 400};
  for (std::uint16_t& mm : depth) {
    const std::uint32_t kind = random.below(16);
    if (kind < 2) continue;
    mm = kind < 4   ? ends[random.below(4)]
         : kind < 8 ? static_cast<std::uint16_t>(1 + random.below(65535))
                    : static_cast<std::uint16_t>(1500 + random.below(800));
  }
  return depth;
}

}  // namespace vesalius::test
