#include <limits>
#include <string_view>

#include "io/model/model_trees.h"

namespace vesalius {
namespace {

// Where a node's child is: most often the next one not yet reached, which costs no further byte.
enum Child : unsigned { kNextNode = 0, kNextLeaf = 1, kOtherNode = 2, kOtherLeaf = 3 };
// A leaf that is one class for certain: its label follows, no probabilities.
constexpr unsigned kCertainLeaf = 0x10;

constexpr std::size_t kSmallestNode = 6;
constexpr std::size_t kSmallestLeaf = 1;

std::int16_t read_int16(ByteReader& in) {
  const std::uint32_t code = in.varint("node");
  if (code > 0xFFFF) in.fail("node: number does not fit 16 bits");
  return static_cast<std::int16_t>(unzigzag(code));
}

/// A count of items of at least `smallest` bytes each, so that no file asks for more memory than its size warrants.
std::size_t read_count(ByteReader& in, std::size_t smallest, const char* what) {
  const auto value = in.number<std::uint32_t>(what);
  if (value > in.left() / smallest) {
    in.fail(fmt::format("{} {} cannot be in the {} bytes left", value, what, in.left()));
  }
  return value;
}

/// Children in the order of the file.
struct NextChild {
  std::int32_t node = 1;
  std::int32_t leaf = 0;
};

std::int32_t read_child(ByteReader& in, unsigned kind, NextChild& next) {
  if (kind == kNextNode) return next.node++;
  if (kind == kNextLeaf) return ~next.leaf++;
  const std::uint32_t index = in.varint("child");
  if (index > static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max())) in.fail("child: out of range");
  return kind == kOtherNode ? static_cast<std::int32_t>(index) : ~static_cast<std::int32_t>(index);
}

TreeNode read_node(ByteReader& in, NextChild& next) {
  const auto kinds = in.number<std::uint8_t>("node");
  if (kinds > 0x0F) in.fail(fmt::format("node: unknown kind {}", kinds));
  TreeNode node;
  for (std::int16_t* value : {&node.du1, &node.dv1, &node.du2, &node.dv2, &node.threshold_mm}) {
    *value = read_int16(in);
  }
  node.left = read_child(in, kinds & 3U, next);
  node.right = read_child(in, kinds >> 2U, next);
  return node;
}

TreeLeaf read_leaf(ByteReader& in) {
  TreeLeaf leaf;
  const auto used = in.number<std::uint8_t>("leaf");
  if (used > kCertainLeaf) in.fail(fmt::format("leaf: unknown kind {}", used));
  if (used == kCertainLeaf) {
    leaf.label[0] = in.number<std::uint8_t>("leaf");
    leaf.probability[0] = 255;
    return leaf;
  }
  for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
    if ((used >> k & 1U) == 0) continue;
    leaf.label[k] = in.number<std::uint8_t>("leaf");
    leaf.probability[k] = in.number<std::uint8_t>("leaf");
  }
  return leaf;
}

Tree read_tree(ByteReader& in) {
  const std::size_t nodes = read_count(in, kSmallestNode, "nodes");
  const std::size_t leaves = read_count(in, kSmallestLeaf, "leaves");
  Tree tree;
  tree.nodes.reserve(nodes);
  tree.leaves.reserve(leaves);
  NextChild next;
  for (std::size_t n = 0; n < nodes; ++n) tree.nodes.push_back(read_node(in, next));
  for (std::size_t l = 0; l < leaves; ++l) tree.leaves.push_back(read_leaf(in));
  return tree;
}

}  // namespace

std::vector<Tree> read_trees_v1(ByteReader& in) {
  std::vector<Tree> trees;
  const std::size_t count = read_count(in, 2 * sizeof(std::uint32_t), "trees");
  for (std::size_t t = 0; t < count; ++t) trees.push_back(read_tree(in));
  return trees;
}

}  // namespace vesalius
