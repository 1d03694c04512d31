#include "vesalius/forest/packed_tree.h"

#include <gmock/gmock.h>

namespace vesalius {
namespace {

using testing::ElementsAre;

/// Returns a root with a leaf on the left and, on the right, a node whose children are leaves.
Tree small_tree() {
  Tree tree;
  tree.nodes = {{.du1 = 1, .dv1 = -2, .du2 = 127, .dv2 = -128, .threshold_mm = -3, .left = ~2, .right = 1},
                {.threshold_mm = 5, .left = ~0, .right = ~1}};
  tree.leaves.resize(3);
  return tree;
}

TEST(PackedTree, HasChildrenSideBySide) {
  const PackedTree packed = pack(small_tree(), {});
  EXPECT_FALSE(packed.wide);
  EXPECT_EQ(packed.link_bits, 28) << "-3 and 5 take four bits";
  EXPECT_EQ(packed.levels, 2);
  const std::uint32_t root = 0x00FF7E81, plain = 0x80808080;
  EXPECT_THAT(packed.words, ElementsAre(root, 0xD0000001, 0, 0,   // root; never reached
                                        2, 0, plain, 0x50000002,  // its children, link 1
                                        0, 0, 1, 0));             // those of node 1, link 2
}

TEST(PackedTree, IsWideIfOffsetsOrLinksNeedIt) {
  Tree tree = small_tree();
  tree.nodes[1].dv2 = 128;
  const PackedTree packed = pack(tree, {});
  ASSERT_TRUE(packed.wide);
  EXPECT_THAT(std::vector<std::uint32_t>(packed.words.begin(), packed.words.begin() + 4),
              ElementsAre(0xFFFE0001, 0xFF80007F, static_cast<std::uint32_t>(-3), 1));
  EXPECT_EQ(packed.words.size(), 24U);
  // The chain has one node more than 16 bits of link can distinguish.
  Tree chain;
  chain.leaves.resize(1);
  for (std::int32_t n = 0; n < 65535; ++n) {
    chain.nodes.push_back({.threshold_mm = -32768, .left = ~0, .right = n < 65534 ? n + 1 : ~0});
  }
  EXPECT_FALSE(pack(chain, {}).wide);
  chain.nodes.push_back(chain.nodes.back());
  EXPECT_TRUE(pack(chain, {}).wide);
  EXPECT_FALSE(pack(chain, {.clip_mm = 1000}).wide) << "a feature is at least -2000 then";
}

TEST(PackedTree, HasTheLevelsOfTheLongestPath) {
  Tree tree = small_tree();  // the last node is a child of the first and of the second
  tree.nodes[0].left = 2;
  tree.nodes[1].left = 2;
  tree.nodes.push_back({.left = ~0, .right = ~1});
  EXPECT_EQ(pack(tree, {}).levels, 3);
  std::swap(tree.nodes[0].left, tree.nodes[0].right);
  EXPECT_EQ(pack(tree, {}).levels, 3);
}

TEST(PackedTree, IsALeafWithoutNodes) {
  Tree tree;
  tree.leaves = {{{7, 99, 99, 3}, {200, 0, 0, 50}}};
  const PackedTree packed = pack(tree, {});
  EXPECT_THAT(packed.words, ElementsAre(0, 0, 0, 0));
  EXPECT_EQ(packed.levels, 0);
  EXPECT_THAT(packed.leaves[0].label, ElementsAre(7, 0, 0, 3)) << "slots without probability name no class";
}

}  // namespace
}  // namespace vesalius
