#include "io/model/model_trees.h"

#include <functional>

#include "io/files/packed.h"
#include "io/files/test_files.h"
#include "io/model/test_forest.h"

namespace vesalius {
namespace {

using test::error_of;
using test::grow_randomly;
using testing::HasSubstr;

constexpr int kClasses = 26;

std::string written(const std::vector<Tree>& trees) {
  ByteWriter out;
  write_trees(out, trees);
  return out.bytes();
}

std::vector<Tree> read(const std::string& bytes) {
  const std::string name = "test";
  ByteReader in(bytes, name);
  std::vector<Tree> trees = read_trees(in);
  in.expect_end();
  return trees;
}

Tree depth_first_tree(std::uint32_t nodes, std::uint64_t seed) {
  Random random(seed);
  Tree tree;
  grow_randomly(tree, nodes, random, kClasses);
  return tree;
}

/// Returns a tree that decides the same, with nodes and leaves in level order.
Tree level_order(const Tree& tree) {
  Tree out;
  std::vector<std::int32_t> queue = {0};
  const auto add = [&](std::int32_t child) {
    if (child < 0) {
      out.leaves.push_back(tree.leaves[~child]);
      return ~static_cast<std::int32_t>(out.leaves.size() - 1);
    }
    queue.push_back(child);
    return static_cast<std::int32_t>(queue.size() - 1);
  };
  for (std::size_t n = 0; n < queue.size(); ++n) {
    TreeNode node = tree.nodes[queue[n]];
    node.left = add(node.left);
    node.right = add(node.right);
    out.nodes.push_back(node);
  }
  return out;
}

/// Returns a chain: every right (or left) child is a leaf.
Tree chain(std::int32_t nodes, bool to_the_left) {
  Random random(8);
  Tree tree;
  for (std::int32_t n = 0; n < nodes; ++n) {
    TreeNode node = test::random_node(random);
    node.left = to_the_left && n + 1 < nodes ? n + 1 : ~n;
    node.right = !to_the_left && n + 1 < nodes ? n + 1 : ~n;
    tree.nodes.push_back(node);
    tree.leaves.push_back(test::random_leaf(random, kClasses));
  }
  return tree;
}

void expect_round_trip(const std::vector<Tree>& trees) { ASSERT_EQ(read(written(trees)), trees); }

TEST(ModelTrees, KeepsTreesOfEveryShape) {
  expect_round_trip({});
  expect_round_trip({depth_first_tree(0, 1)});
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const auto nodes = 1 + static_cast<std::uint32_t>(seed) * static_cast<std::uint32_t>(seed) / 4;
    const Tree first = depth_first_tree(nodes, seed);
    // The last tree shares children and has nodes and leaves that nothing leads to.
    expect_round_trip({first, level_order(first), test::random_tree(random, nodes, 1 + nodes / 2, kClasses)});
  }
  expect_round_trip({chain(500, true), chain(500, false)});
}

TEST(ModelTrees, KeepsExtremeNumbers) {
  Tree tree;
  for (const int offset : {0, 1, -1, 127, 128, -128, -129, kMaxOffset, -kMaxOffset}) {
    for (const int threshold : {0, -1, 255, 256, 32767, -32768}) {
      const auto value = static_cast<std::int16_t>(offset);
      const auto minus = static_cast<std::int16_t>(-offset);
      tree.nodes.push_back({value, minus, minus, value, static_cast<std::int16_t>(threshold), 0, ~0, ~0});
    }
  }
  tree.leaves = {{{0, 0, 0, 0}, {0, 0, 0, 0}},        {{255, 0, 0, 0}, {255, 0, 0, 0}}, {{0, 0, 0, 7}, {0, 0, 0, 9}},
                 {{3, 0, 3, 3}, {1, 0, 100, 2}},      {{1, 2, 3, 4}, {252, 1, 1, 1}},   {{9, 0, 0, 0}, {1, 0, 0, 0}},
                 {{1, 1, 1, 1}, {255, 255, 255, 255}}};
  expect_round_trip({tree});
}

TEST(ModelTrees, DropsLabelsOfUnusedSlots) {
  Random random(7);
  Tree tree;
  for (int l = 0; l < 300; ++l) {
    TreeLeaf& leaf = tree.leaves.emplace_back();
    for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
      leaf.label[k] = static_cast<std::uint8_t>(random.below(kClasses));
      leaf.probability[k] = static_cast<std::uint8_t>(random.below(2) * random.below(60));
    }
  }
  const std::string bytes = written({tree});
  for (TreeLeaf& leaf : tree.leaves) {
    for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
      if (leaf.probability[k] == 0) leaf.label[k] = 0;
    }
  }
  EXPECT_EQ(read(bytes), std::vector<Tree>{tree});
  EXPECT_EQ(written({tree}), bytes);
}

TEST(ModelTrees, TakesFewestBytesInDepthFirstOrder) {
  const Tree tree = depth_first_tree(3000, 4);
  const std::size_t size = written({tree}).size();
  EXPECT_GT(written({level_order(tree)}).size(), size + 3000);
  // The shape takes two bits. A quarter of the random numbers are 13 bits wide, the others 8; leaves have 2.5 labels of
  // 4.7 bits with 5.9 bits of probability.
  EXPECT_LT(size, 3000 * (2 + 3 * (0.25 * 13.5 + 0.75 * 8.5) + 2 + 16 + 2.5 * 10.6) / 8 * 1.1);
}

TEST(ModelTrees, TakesFewBytesForValuesThatFollowFromContext) {
  Random random(6);
  Tree tree = depth_first_tree(20000, 5);
  for (TreeLeaf& leaf : tree.leaves) {
    const auto first = static_cast<std::uint8_t>(128 + random.below(64));
    const auto second = static_cast<std::uint8_t>((255 - first) / 2);
    leaf = {{1, 2, 0, 0}, {first, second, 0, 0}};
  }
  const std::size_t size = written({tree}).size();
  for (TreeLeaf& leaf : tree.leaves) leaf.probability[1] = 0, leaf.label[1] = 0;
  EXPECT_LT(size, written({tree}).size() + 20000 / 16) << "the second follows from the first";
}

TEST(ModelTrees, RefusesEveryTruncation) {
  const std::string bytes = written({depth_first_tree(6, 2), chain(2, true), depth_first_tree(0, 3)});
  for (std::size_t n = 0; n < bytes.size(); ++n) EXPECT_THROW(read(bytes.substr(0, n)), Error) << n;
}

TEST(ModelTrees, ChecksDeclaredSizesBeforeAllocation) {
  const auto message = [](std::uint32_t trees, std::uint32_t nodes, std::uint32_t leaves, std::uint32_t size) {
    ByteWriter out;
    for (const std::uint32_t number : {trees, nodes, leaves, size}) out.number(number);
    return error_of([&] { read(out.bytes()); });
  };
  EXPECT_THAT(message(257, 0, 1, 0), HasSubstr("257 trees, expected at most 256"));
  EXPECT_THAT(message(1, 4294967295U, 1, 0), HasSubstr("4294967295 nodes and 1 leaves, expected at most 8388608"));
  EXPECT_THAT(message(1, 0, 8388609, 0), HasSubstr("0 nodes and 8388609 leaves, expected at most 8388608"));
  EXPECT_THAT(message(1, 0, 1, 4294967295U), HasSubstr("expected 4294967295 bytes of tree, 0 are left"));
  EXPECT_THAT(message(1, 8388608, 8388608, 0), HasSubstr("test: tree 0: damaged at byte 0"));
  Tree large;
  large.leaves.resize(kMaxModelNodes + 1);
  EXPECT_THAT(error_of([&] { written({large}); }), HasSubstr("0 nodes and 8388609 leaves"));
}

/// Returns a tree of one node and two leaves, with this column in place of its own.
std::string with_column(std::size_t index, const std::string& raw) {
  const Tree tree = depth_first_tree(1, 2);
  const std::string bytes = written({tree});
  const std::string name = "test";
  ByteReader in(bytes, name);
  in.take(16, "header");
  ByteWriter columns;
  for (std::size_t i = 0; in.left() > 0; ++i) {
    const std::string column = read_packed(in, 0, 100, "column");
    columns.bytes() += pack(i == index ? raw : column, 1);
  }
  ByteWriter out;
  out.bytes() = bytes.substr(0, 12);
  out.text(columns.bytes());
  return out.bytes();
}

TEST(ModelTrees, RefusesColumnsOfAnotherSizeOrMeaning) {
  EXPECT_NO_THROW(read(with_column(0, "\x05"))) << "two leaves: the tree's own column";
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_THAT(error_of([&] { read(with_column(i, std::string(50, '\0'))); }), HasSubstr("test: tree 0"));
  }
  EXPECT_THAT(error_of([&] { read(with_column(0, "\x10")); }), HasSubstr("node 0: unknown kind 16"));
  EXPECT_THAT(error_of([&] { read(with_column(0, "\x0d")); }), HasSubstr("expected 1 bytes of child, 0 are left"));
  EXPECT_THAT(error_of([&] { read(with_column(1, "\x01")); }), HasSubstr("expected the end, 1 bytes are left"));
  EXPECT_THAT(error_of([&] { read(with_column(1, "\xff\xff\xff\xff\x1f")); }), HasSubstr("tree 0"));
}

TEST(ModelTrees, LeavesChildrenOutsideTheTreeToTheForestsCheck) {
  for (const char kinds : {'\0', '\x01', '\x04'}) {  // node 1 of a tree that has one node
    Forest forest;
    forest.body = paper_body();
    forest.has_background = true;
    forest.trees = read(with_column(0, {kinds}));
    EXPECT_THROW(check(forest), Error) << static_cast<int>(kinds);
  }
}

}  // namespace
}  // namespace vesalius
