#pragma once

#include <cstdint>
#include <string>

#include "io/files/byte_stream.h"
#include "vesalius/base/random.h"
#include "vesalius/forest.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/model.h"

// Forests that the tests of model files share.
namespace vesalius::test {

inline std::int16_t random_int16(Random& random, int bound) {
  return static_cast<std::int16_t>(static_cast<int>(random.below(static_cast<std::uint32_t>(2 * bound + 1))) - bound);
}

inline TreeNode random_node(Random& random) {
  TreeNode node;
  const int bound = random.below(4) == 0 ? kMaxOffset : 100;
  for (std::int16_t* value : {&node.du1, &node.dv1, &node.du2, &node.dv2}) *value = random_int16(random, bound);
  if (random.below(2) == 0) node.du2 = node.dv2 = 0;
  node.threshold_mm = random_int16(random, 32767);
  return node;
}

inline TreeLeaf random_leaf(Random& random, int classes) {
  TreeLeaf leaf;
  const std::uint32_t used = 1 + random.below(TreeLeaf::kClasses);
  for (std::size_t k = 0; k < used; ++k) {
    leaf.label[k] = static_cast<std::uint8_t>(random.below(static_cast<std::uint32_t>(classes)));
    leaf.probability[k] = used == 1 ? 255 : static_cast<std::uint8_t>(1 + random.below(60));
  }
  return leaf;
}

/// Returns a tree whose nodes have any later node or any leaf as children, which covers every shape that check()
/// allows.
inline Tree random_tree(Random& random, std::uint32_t nodes, std::uint32_t leaves, int classes) {
  Tree tree;
  const auto child = [&](std::uint32_t parent) {
    const bool inner = parent + 1 < nodes && random.below(2) == 0;
    if (!inner) return ~static_cast<std::int32_t>(random.below(leaves));
    return static_cast<std::int32_t>(parent + 1 + random.below(nodes - parent - 1));
  };
  for (std::uint32_t n = 0; n < nodes; ++n) {
    TreeNode node = random_node(random);
    node.left = child(n);
    node.right = child(n);
    tree.nodes.push_back(node);
  }
  for (std::uint32_t l = 0; l < leaves; ++l) tree.leaves.push_back(random_leaf(random, classes));
  return tree;
}

/// Appends a random subtree with `nodes` nodes in depth-first order, as trainers do. Returns the index by which its
/// parent refers to it.
inline std::int32_t grow_randomly(Tree& tree, std::uint32_t nodes, Random& random, int classes) {
  if (nodes == 0) {
    tree.leaves.push_back(random_leaf(random, classes));
    return ~static_cast<std::int32_t>(tree.leaves.size() - 1);
  }
  const std::size_t at = tree.nodes.size();
  tree.nodes.push_back(random_node(random));
  const std::uint32_t left = random.below(nodes);
  const std::int32_t left_child = grow_randomly(tree, left, random, classes);
  const std::int32_t right_child = grow_randomly(tree, nodes - 1 - left, random, classes);
  tree.nodes[at].left = left_child;
  tree.nodes[at].right = right_child;
  return static_cast<std::int32_t>(at);
}

inline Forest random_forest(std::uint64_t seed, std::uint32_t nodes = 200) {
  Random random(seed);
  Forest forest;
  forest.body = paper_body();
  forest.has_background = random.below(2) == 0;
  forest.convention = {.offset_unit = 0.25F, .hole_mm = 65535, .outside_mm = 1, .clip_mm = 300};
  forest.recipe = "random " + std::to_string(seed);
  for (int t = 0; t < 2; ++t) forest.trees.push_back(random_tree(random, nodes, nodes + 1, forest.class_count()));
  grow_randomly(forest.trees.emplace_back(), nodes, random, forest.class_count());
  forest.trees.push_back({.nodes = {}, .leaves = {random_leaf(random, 25)}});
  return forest;
}

/// Returns a forest so small that a test can change every byte of its file.
inline Forest tiny_forest() {
  Forest forest = random_forest(3, 5);
  forest.body = parse_body_model(R"(name = "one"
roots = ["all"]
[[part]]
name = "all"
colour = [0, 0, 0]
mirror = "all"
max_extent = 1
area = 1
upper_body = true
)",
                                 "one");
  for (Tree& tree : forest.trees) {
    for (TreeLeaf& leaf : tree.leaves) leaf.label = {};
  }
  return forest;
}

/// Gives the leaves of a forest random logits in place of classes, and the forest a random regression of headings.
inline void add_logits(Forest& forest, int headings, Random& random) {
  const LogitLayout layout(forest.body, forest.has_background, headings);
  forest.logit_unit = 0.0625F;
  forest.headings = headings;
  for (Tree& tree : forest.trees) {
    std::ranges::fill(tree.leaves, TreeLeaf{});
    tree.logits.resize(tree.leaves.size() * static_cast<std::size_t>(layout.size()));
    for (std::int8_t& logit : tree.logits) logit = static_cast<std::int8_t>(static_cast<int>(random.below(256)) - 128);
  }
  forest.facing = {headings, forest.body.part_count(), {}};
  forest.facing.weights.resize(forest.facing.features() * static_cast<std::size_t>(headings));
  for (float& weight : forest.facing.weights) weight = static_cast<float>(random.uniform(-1.0, 1.0));
}

/// Gives the model a random judge of people.
inline void add_judge(Model& model, int trees, Random& random) {
  constexpr int kFeatures = 30;
  model.judge = {kFeatures, 0.25F, std::vector<BoostedTree>(trees)};
  for (BoostedTree& tree : model.judge.trees) {
    for (std::uint16_t& feature : tree.feature) feature = static_cast<std::uint16_t>(random.below(kFeatures));
    for (float& threshold : tree.threshold) threshold = static_cast<float>(random.uniform());
    for (float& value : tree.value) value = static_cast<float>(random.uniform(-1.0, 1.0));
  }
}

}  // namespace vesalius::test
