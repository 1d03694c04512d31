#pragma once

// Forests of every kind that a device must label with, and scenes for them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/forest.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/forest/test_trees.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"

namespace vesalius::test {

enum class LeafKind { votes, distributions, logits, headings };

struct ForestKind {
  LeafKind leaves = LeafKind::headings;
  bool background = true;
  int trees = 3;
  int max_offset = 127;  ///< above 127 nodes take four words
  std::uint16_t clip_mm = 800;
  int more_parts = 0;  ///< than the paper's body has
};

inline TreeLeaf random_leaf(Random& random, int classes, bool vote) {
  TreeLeaf leaf;
  int left = 255;
  for (std::size_t k = 0; k < (vote ? 1U : TreeLeaf::kClasses) && left > 0; ++k) {
    // The background is likely, so that the gate has something to do.
    const bool background = k == 0 && random.below(2) == 0;
    leaf.label[k] = static_cast<std::uint8_t>(background ? classes - 1 : static_cast<int>(random.below(classes)));
    leaf.probability[k] = static_cast<std::uint8_t>(vote ? 255 : 1 + random.below(static_cast<std::uint32_t>(left)));
    left -= leaf.probability[k];
  }
  return leaf;
}

inline Forest random_forest(Random& random, const ForestKind& kind) {
  Forest forest;
  forest.body = paper_body();
  for (int p = 0; p < kind.more_parts; ++p) {
    BodyPart part = forest.body.parts.front();
    part.name = "l_more_" + std::to_string(p);
    part.mirror = p % 3 == 0 ? forest.body.part_count() : 0;
    forest.body.parts.push_back(part);
  }
  forest.has_background = kind.background;
  forest.convention.clip_mm = kind.clip_mm;
  forest.headings = kind.leaves == LeafKind::headings ? 8 : 0;
  const bool logits = kind.leaves == LeafKind::headings || kind.leaves == LeafKind::logits;
  forest.logit_unit = logits ? 0.03F : 0.F;
  const LogitLayout layout(forest.body, forest.has_background, forest.headings);
  for (int t = 0; t < kind.trees; ++t) {
    Tree tree = random_tree(random, {.nodes = 60 + 20 * t, .max_offset = kind.max_offset});
    for (TreeLeaf& leaf : tree.leaves) {
      leaf = random_leaf(random, forest.class_count(), kind.leaves == LeafKind::votes);
    }
    if (logits) {
      tree.logits.resize(tree.leaves.size() * static_cast<std::size_t>(layout.size()));
      for (std::size_t i = 0; i < tree.logits.size(); ++i) {
        const int c = static_cast<int>(i % static_cast<std::size_t>(layout.size()));
        const int more = kind.background && c == forest.body.part_count() ? 60 : 0;
        tree.logits[i] = static_cast<std::int8_t>(std::min(static_cast<int>(random.below(200)) - 100 + more, 127));
      }
    }
    forest.trees.push_back(std::move(tree));
  }
  return forest;
}

/// Returns walls at several depths with noise, holes and steps, on which a gate closes here and there.
inline DepthImage random_scene(Random& random, int width, int height) {
  DepthImage depth(width, height, 0);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      if (random.below(15) == 0) continue;
      const int wall = (u / 16 + v / 16) % 3;
      depth(u, v) = static_cast<std::uint16_t>(1200 + 900 * wall + static_cast<int>(random.below(40)));
    }
  }
  if (!depth.empty()) depth(width - 1, height - 1) = 65535;
  return depth;
}

/// Expects equal bits wherever posteriors are defined: headings only of pixels about which a forest was asked.
inline void expect_same(const Posteriors& found, const Posteriors& expected, const DepthImage& depth) {
  ASSERT_EQ(found.width, expected.width);
  ASSERT_EQ(found.height, expected.height);
  ASSERT_EQ(found.classes, expected.classes);
  ASSERT_EQ(found.whole, expected.whole);
  ASSERT_EQ(found.headings, expected.headings);
  ASSERT_EQ(found.settled, expected.settled);
  ASSERT_EQ(found.sums, expected.sums);
  ASSERT_EQ(found.votes, expected.votes);
  ASSERT_EQ(found.part_votes, expected.part_votes);
  for (int v = 0; v < depth.height() && found.headings > 0; ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) == 0 || (!expected.settled.empty() && expected.settled(u, v) != 0)) continue;
      ASSERT_TRUE(
          std::equal(expected.turns_at(u, v), expected.turns_at(u, v) + expected.turn_count(), found.turns_at(u, v)))
          << "headings of pixel " << u << ", " << v;
    }
  }
}

}  // namespace vesalius::test
