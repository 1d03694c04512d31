#include "vesalius/forest.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "vesalius/error.h"
#include "vesalius/forest/leaf_logits.h"

namespace vesalius {
namespace {

[[noreturn]] void bad_tree(std::size_t tree, const std::string& what) {
  throw Error("tree " + std::to_string(tree) + ": " + what);
}

void check_child(std::int32_t child, std::size_t parent, std::size_t tree, const Tree& t) {
  if (child >= 0) {
    // Children come after their parent, so no walk can go in a circle.
    if (static_cast<std::size_t>(child) <= parent || static_cast<std::size_t>(child) >= t.nodes.size()) {
      bad_tree(tree, "node " + std::to_string(parent) + " has child " + std::to_string(child) +
                         ", expected a later node below " + std::to_string(t.nodes.size()));
    }
  } else if (static_cast<std::size_t>(~child) >= t.leaves.size()) {
    bad_tree(tree, "node " + std::to_string(parent) + " has leaf " + std::to_string(~child) + " of " +
                       std::to_string(t.leaves.size()));
  }
}

void check_tree(const Tree& t, std::size_t tree, int classes) {
  if (t.leaves.empty()) bad_tree(tree, "no leaves");
  for (std::size_t n = 0; n < t.nodes.size(); ++n) {
    const TreeNode& node = t.nodes[n];
    check_child(node.left, n, tree, t);
    check_child(node.right, n, tree, t);
    for (const int offset : {node.du1, node.dv1, node.du2, node.dv2}) {
      if (std::abs(offset) > kMaxOffset) {
        bad_tree(tree, "node " + std::to_string(n) + " has offset " + std::to_string(offset) + ", expected at most " +
                           std::to_string(kMaxOffset));
      }
    }
  }
  for (std::size_t l = 0; l < t.leaves.size(); ++l) {
    const TreeLeaf& leaf = t.leaves[l];
    int sum = 0;
    for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
      sum += leaf.probability[k];
      if (leaf.probability[k] != 0 && leaf.label[k] >= classes) {
        bad_tree(tree, "leaf " + std::to_string(l) + " names class " + std::to_string(leaf.label[k]) + " of " +
                           std::to_string(classes));
      }
    }
    if (sum > 255) bad_tree(tree, "leaf " + std::to_string(l) + " has probabilities above 1");
  }
}

void check_logits(const Forest& forest) {
  constexpr int kMostHeadings = 64;
  const bool has = forest.logit_unit != 0.F;
  if (!std::isfinite(forest.logit_unit) || forest.logit_unit < 0.F) throw Error("forest: unit of logits below 0");
  if (forest.headings < 0 || forest.headings > kMostHeadings || (!has && forest.headings != 0)) {
    throw Error("forest: " + std::to_string(forest.headings) + " headings, expected 0 to 64");
  }
  check(forest.facing, forest.body.part_count(), forest.headings);
  const std::size_t size = LogitLayout(forest.body, forest.has_background, forest.headings).size();
  for (std::size_t t = 0; t < forest.trees.size(); ++t) {
    const std::size_t expected = has ? forest.trees[t].leaves.size() * size : 0;
    if (forest.trees[t].logits.size() != expected) {
      bad_tree(t, std::to_string(forest.trees[t].logits.size()) + " logits, expected " + std::to_string(expected));
    }
  }
}

}  // namespace

void check(const FacingModel& model, int parts, int headings) {
  const bool fits = model.headings == headings && model.parts == parts &&
                    model.weights.size() == model.features() * static_cast<std::size_t>(headings);
  if (!model.empty() && !fits) throw Error("regression of headings for other parts or headings");
  if (std::ranges::any_of(model.weights, [](float w) { return !std::isfinite(w); })) {
    throw Error("regression of headings has a weight that is no number");
  }
}

void check(const Forest& forest) {
  if (forest.body.parts.empty()) throw Error("forest: body model without parts");
  if (forest.trees.empty()) throw Error("forest: no trees");
  // Sums of probabilities in 1/255 must fit 16 bits.
  if (forest.trees.size() > 256) throw Error("forest: " + std::to_string(forest.trees.size()) + " trees, at most 256");
  const FeatureConvention& c = forest.convention;
  if (!std::isfinite(c.offset_unit) || c.offset_unit <= 0.F || !std::isfinite(c.reference_focal_px) ||
      c.reference_focal_px <= 0.F) {
    throw Error("forest: offset unit and reference focal length must be positive");
  }
  for (std::size_t t = 0; t < forest.trees.size(); ++t) check_tree(forest.trees[t], t, forest.class_count());
  check_logits(forest);
}

int depth(const Tree& tree) {
  std::vector<int> depth_of(tree.nodes.size(), 0);
  int deepest = 0;
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    const int below = depth_of[n] + 1;
    deepest = std::max(deepest, below);
    for (const std::int32_t child : {tree.nodes[n].left, tree.nodes[n].right}) {
      if (child < 0) continue;
      int& child_depth = depth_of[child];
      child_depth = std::max(child_depth, below);  // several nodes may share a child
    }
  }
  return deepest;
}

bool has_distributions(const Forest& forest) {
  if (forest.logit_unit > 0.F) return true;
  const auto mixed = [](const TreeLeaf& leaf) {
    return std::ranges::count_if(leaf.probability, [](int p) { return p != 0; }) > 1;
  };
  return std::ranges::any_of(forest.trees, [&](const Tree& t) { return std::ranges::any_of(t.leaves, mixed); });
}

}  // namespace vesalius
