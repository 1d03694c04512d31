#include "train/growing_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

namespace vesalius {
namespace {

std::int32_t add_leaf(Tree& tree, const TreeLeaf& leaf) {
  tree.leaves.push_back(leaf);
  return ~static_cast<std::int32_t>(tree.leaves.size() - 1);
}

/// Returns how a parent refers to the subtree.
std::int32_t add_subtree(Tree& tree, const std::vector<GrownNode>& nodes, std::size_t at) {
  const GrownNode& grown = nodes[at];
  if (grown.left == 0) return add_leaf(tree, grown.leaf);
  const std::size_t index = tree.nodes.size();
  tree.nodes.push_back(grown.split);
  const std::int32_t left = add_subtree(tree, nodes, grown.left);
  const std::int32_t right = add_subtree(tree, nodes, grown.right);
  const auto leaf = [&](std::int32_t child) { return tree.leaves[~child]; };
  if (left < 0 && right < 0 && leaf(left) == leaf(right)) {
    const TreeLeaf same = leaf(left);
    tree.nodes.pop_back();
    tree.leaves.resize(tree.leaves.size() - 2);
    return add_leaf(tree, same);
  }
  tree.nodes[index].left = left;
  tree.nodes[index].right = right;
  return static_cast<std::int32_t>(index);
}

/// Returns integers in proportion to `factors`. The largest is 2^24 and none is 0.
std::vector<std::uint64_t> fixed_point(const std::vector<double>& factors) {
  constexpr double kLargest = 16777216.0;
  const double largest = factors.empty() ? 1.0 : *std::ranges::max_element(factors);
  std::vector<std::uint64_t> weights;
  weights.reserve(factors.size());
  for (const double factor : factors) {
    weights.push_back(static_cast<std::uint64_t>(std::max(1.0, std::round(kLargest * factor / largest))));
  }
  return weights;
}

}  // namespace

int least_samples(const LevelNode& node, const LeafOptions& options) {
  return int((options.min_samples * node.counted + node.size - 1) / node.size);
}

int depth_of(std::uint32_t number) { return std::bit_width(number) - 1; }

GrowingTree::GrowingTree(const SampleCounts& samples, int parts, const GrowTreeOptions& options)
    : classes_(samples.samples.size()), options_(options), leaves_(samples, parts, options.leaf) {}

std::vector<std::int32_t> GrowingTree::begin(std::span<const TreeRoot> roots) {
  nodes_.resize(roots.size());
  std::vector<std::int32_t> node_of_child;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    node_of_child.push_back(open_or_settle(roots[i].number, i, roots[i].counts.data()));
  }
  return node_of_child;
}

/// Makes a node of the next level, or a leaf if no split is possible. Returns the node's index or kSettled.
std::int32_t GrowingTree::open_or_settle(std::uint32_t number, std::size_t at, const std::int64_t* counts) {
  const std::int64_t size = std::accumulate(counts, counts + classes_, std::int64_t{0});
  const auto present = int(std::count_if(counts, counts + classes_, [](auto n) { return n > 0; }));
  nodes_[at].leaf = leaves_.leaf(counts);
  const int depth = depth_of(number);
  if (depth >= options_.leaf.max_depth || present < 2 || size < 2 * options_.leaf.min_samples) {
    settled_ += size * (options_.leaf.max_depth - depth);
    return kSettled;
  }
  OpenNode open;
  open.node = {number, size, std::min<std::int64_t>(size, options_.split.split_pixels)};
  open.at = at;
  open.classes = present;
  level_.push_back(open);
  return static_cast<std::int32_t>(level_.size() - 1);
}

bool GrowingTree::offer(std::int32_t node, const TreeNode& split, double gain) {
  OpenNode& open = level_[node];
  if (gain < double(options_.split.min_gain) || gain <= open.gain) return false;
  open.gain = gain;
  open.split = split;
  return true;
}

std::vector<std::int32_t> GrowingTree::descend(const ChildCounts& children) {
  const std::vector<OpenNode> parents = std::exchange(level_, {});
  std::vector<std::int32_t> node_of_child(2 * parents.size(), kSettled);
  for (std::size_t n = 0; n < parents.size(); ++n) {
    const OpenNode& parent = parents[n];
    if (parent.gain <= 0.0) {
      settled_ += parent.node.size * (options_.leaf.max_depth - depth_of(parent.node.number));
      continue;
    }
    settled_ += parent.node.size;
    ++split_nodes_;
    const std::size_t left = nodes_.size();
    nodes_[parent.at].split = parent.split;
    nodes_[parent.at].left = left;
    nodes_[parent.at].right = left + 1;
    nodes_.resize(nodes_.size() + 2);
    for (std::uint32_t side = 0; side < 2; ++side) {
      const std::size_t child = 2 * n + side;
      node_of_child[child] = open_or_settle(2 * parent.node.number + side, left + side, children.of(child));
    }
  }
  return node_of_child;
}

OpenTree GrowingTree::open_level() const { return open_tree(false); }

OpenTree GrowingTree::open_children() const { return open_tree(true); }

/// Nodes keep their order, so children come after their parents.
OpenTree GrowingTree::open_tree(bool children) const {
  OpenTree open;
  open.children = children ? 2 * level_.size() : level_.size();
  std::vector<std::int32_t> open_at(nodes_.size(), kSettled);
  for (std::size_t n = 0; n < level_.size(); ++n) open_at[level_[n].at] = static_cast<std::int32_t>(n);
  std::vector<std::int32_t> inner(nodes_.size(), -1);  // index among the nodes of the result
  std::int32_t count = 0;
  const auto splits = [&](std::size_t at) {
    return nodes_[at].left != 0 || (children && open_at[at] != kSettled && level_[open_at[at]].gain > 0.0);
  };
  for (std::size_t at = 0; at < nodes_.size(); ++at) {
    if (splits(at)) inner[at] = count++;
  }
  const auto leaf = [&](std::int32_t child) {
    open.child_of_leaf.push_back(child);
    return ~static_cast<std::int32_t>(open.child_of_leaf.size() - 1);
  };
  const auto refer = [&](std::size_t at) {
    return inner[at] >= 0 ? inner[at] : leaf(children ? kSettled : open_at[at]);
  };
  for (std::size_t at = 0; at < nodes_.size(); ++at) {
    if (inner[at] < 0) continue;
    const bool grown = nodes_[at].left != 0;
    TreeNode node = grown ? nodes_[at].split : level_[open_at[at]].split;
    node.left = grown ? refer(nodes_[at].left) : leaf(2 * open_at[at]);
    node.right = grown ? refer(nodes_[at].right) : leaf(2 * open_at[at] + 1);
    open.tree.nodes.push_back(node);
  }
  if (open.tree.nodes.empty()) leaf(children ? kSettled : open_at[0]);
  return open;
}

void GrowingTree::graft(std::int32_t node, std::span<const GrownNode> grown) {
  const std::size_t at = level_[node].at;
  const std::size_t shift = nodes_.size() - 1;  // the root takes the node's place
  for (std::size_t i = 0; i < grown.size(); ++i) {
    GrownNode copy = grown[i];
    if (copy.left != 0) {
      copy.left += shift;
      copy.right += shift;
      ++split_nodes_;
    }
    if (i == 0) {
      nodes_[at] = copy;
    } else {
      nodes_.push_back(copy);
    }
  }
  settled_ += level_[node].node.size * (options_.leaf.max_depth - depth_of(level_[node].node.number));
}

std::vector<GrownNode> GrowingTree::subtree(std::size_t at) const {
  std::vector<GrownNode> grown{nodes_[at]};
  for (std::size_t i = 0; i < grown.size(); ++i) {
    if (grown[i].left == 0) continue;
    const std::size_t left = grown[i].left, right = grown[i].right;
    grown[i].left = grown.size();
    grown[i].right = grown.size() + 1;
    grown.push_back(nodes_[left]);
    grown.push_back(nodes_[right]);
  }
  return grown;
}

Tree pruned_tree(const std::vector<GrownNode>& nodes) {
  Tree tree;
  add_subtree(tree, nodes, 0);
  return tree;
}

LeafShares::LeafShares(const SampleCounts& counts, int parts, const LeafOptions& options) {
  const std::vector<std::int64_t>& sampled = counts.samples;
  std::vector<double> factors(sampled.size(), 0.0);
  for (std::size_t c = 0; c < factors.size(); ++c) {
    if (sampled[c] == 0) continue;
    const double pixels = std::max<double>(double(counts.pixels[c]), 1.0);
    factors[c] = std::pow(pixels / double(sampled[c]), double(options.prior_correction));
  }
  weights_ = fixed_point(factors);
  if (options.part_balance == 0.F) return;
  factors.resize(parts);
  for (std::size_t c = 0; c < factors.size(); ++c) {
    if (sampled[c] == 0) continue;
    factors[c] *= std::pow(double(sampled[c]), -double(options.part_balance));
  }
  balance_ = fixed_point(factors);
}

/// Distributes the parts' total share anew.
void LeafShares::balance_parts(const std::int64_t* counts, std::vector<std::uint64_t>& shares) const {
  std::uint64_t before = 0;
  std::uint64_t after = 0;
  for (std::size_t c = 0; c < balance_.size(); ++c) {
    before += shares[c];
    after += static_cast<std::uint64_t>(counts[c]) * balance_[c];
  }
  if (after == 0) return;
  const double scale = double(before) / double(after);
  for (std::size_t c = 0; c < balance_.size(); ++c) {
    shares[c] = static_cast<std::uint64_t>(scale * double(counts[c]) * double(balance_[c]));
  }
}

TreeLeaf LeafShares::leaf(const std::int64_t* counts) const {
  std::vector<std::uint64_t> shares(weights_.size());
  for (std::size_t c = 0; c < shares.size(); ++c) shares[c] = static_cast<std::uint64_t>(counts[c]) * weights_[c];
  if (!balance_.empty()) balance_parts(counts, shares);
  const std::uint64_t total = std::accumulate(shares.begin(), shares.end(), std::uint64_t{0});
  std::vector<std::size_t> order(shares.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t kept = std::min<std::size_t>(TreeLeaf::kClasses, order.size());
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end(),
      [&](std::size_t a, std::size_t b) { return shares[a] != shares[b] ? shares[a] > shares[b] : a < b; });
  TreeLeaf leaf;
  for (std::size_t k = 0; k < kept; ++k) {
    const std::uint64_t share = shares[order[k]] * 255 / total;
    if (share == 0) break;
    leaf.label[k] = static_cast<std::uint8_t>(order[k]);
    leaf.probability[k] = static_cast<std::uint8_t>(share);
  }
  return leaf;
}

}  // namespace vesalius
