#include "vesalius/forest/packed_tree.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kMaxNodes = std::size_t{1} << 26U;

/// Returns the largest absolute difference of two probes in mm.
int feature_limit_mm(const FeatureConvention& convention) {
  return convention.clip_mm != 0 ? 2 * convention.clip_mm : 65535;
}

int clamped_threshold(const TreeNode& node, int limit) { return std::clamp<int>(node.threshold_mm, -limit - 1, limit); }

/// Returns the bits of a two's complement number.
int signed_bits(int value) { return std::bit_width(static_cast<unsigned>(value < 0 ? ~value : value)) + 1; }

/// Returns the link of an inner node: node n has link n + 1, as 0 means leaf.
std::uint32_t link_of(std::int32_t node) { return static_cast<std::uint32_t>(node) + 1; }

std::uint32_t half_words(int low, int high) {
  return static_cast<std::uint16_t>(low) | static_cast<std::uint32_t>(static_cast<std::uint16_t>(high)) << 16U;
}

class Packer {
 public:
  Packer(const Tree& tree, const FeatureConvention& convention) : tree_(tree), limit_(feature_limit_mm(convention)) {
    int threshold_bits = 1;
    for (const TreeNode& node : tree.nodes) {
      threshold_bits = std::max(threshold_bits, signed_bits(clamped_threshold(node, limit_)));
      for (const int offset : {node.du1, node.dv1, node.du2, node.dv2}) {
        packed_.wide = packed_.wide || offset < -128 || offset > 127;
      }
    }
    packed_.link_bits = 32 - threshold_bits;
    packed_.levels = depth(tree);
    packed_.wide = packed_.wide || tree.nodes.size() >> static_cast<unsigned>(packed_.link_bits) != 0;
  }

  PackedTree run() && {
    packed_.words.assign((2 * tree_.nodes.size() + 2) * static_cast<std::size_t>(packed_.words_per_node()), 0);
    put(0, tree_.nodes.empty() ? ~0 : 0);
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      const std::size_t children = 2 * static_cast<std::size_t>(link_of(static_cast<std::int32_t>(n)));
      put(children, tree_.nodes[n].left);
      put(children + 1, tree_.nodes[n].right);
    }
    packed_.leaves = tree_.leaves;
    for (TreeLeaf& leaf : packed_.leaves) {
      for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) leaf.label[k] = leaf.probability[k] != 0 ? leaf.label[k] : 0;
    }
    pack_logits();
    return std::move(packed_);
  }

 private:
  void pack_logits() {
    if (tree_.logits.empty()) return;
    const std::size_t size = tree_.logits.size() / tree_.leaves.size();
    constexpr std::size_t kLine = sizeof(PackedTree::LogitLine);
    packed_.lines_per_leaf = (size + kLine - 1) / kLine;
    packed_.logits.resize(tree_.leaves.size() * packed_.lines_per_leaf);
    for (std::size_t leaf = 0; leaf < tree_.leaves.size(); ++leaf) {
      PackedTree::LogitLine* line = packed_.logits.data() + leaf * packed_.lines_per_leaf;
      for (std::size_t i = 0; i < size; i += kLine, ++line) {
        std::copy_n(tree_.logits.data() + leaf * size + i, std::min(kLine, size - i), line->values.data());
      }
    }
  }

  /// Writes a node or a leaf, as children are numbered in a TreeNode.
  void put(std::size_t place, std::int32_t child) {
    std::uint32_t* words = packed_.words.data() + place * static_cast<std::size_t>(packed_.words_per_node());
    if (child < 0) {
      words[0] = static_cast<std::uint32_t>(~child);
      return;
    }
    const TreeNode& node = tree_.nodes[child];
    const auto threshold = static_cast<std::uint32_t>(clamped_threshold(node, limit_));
    if (packed_.wide) {
      words[0] = half_words(node.du1, node.dv1);
      words[1] = half_words(node.du2, node.dv2);
      words[2] = threshold;
      words[3] = link_of(child);
      return;
    }
    const int offsets[] = {node.du1, node.dv1, node.du2, node.dv2};
    for (unsigned i = 0; i < 4; ++i) words[0] |= static_cast<std::uint32_t>(offsets[i] + 128) << (8 * i);
    words[1] = threshold << static_cast<unsigned>(packed_.link_bits) | link_of(child);
  }

  const Tree& tree_;
  int limit_;
  PackedTree packed_;
};

}  // namespace

PackedTree pack(const Tree& tree, const FeatureConvention& convention) {
  if (tree.nodes.size() > kMaxNodes) {
    throw Error("tree: " + std::to_string(tree.nodes.size()) + " nodes, expected at most 67108864");
  }
  return Packer(tree, convention).run();
}

}  // namespace vesalius
