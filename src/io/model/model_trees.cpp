#include "io/model/model_trees.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "io/files/packed.h"
#include "vesalius/parallel.h"

// Trees are stored by columns: all first offsets, then all second ones and so on, since numbers of one kind compress
// best together. A column may be sorted by a context, which is something read before it that tells which values to
// expect; zstd then finds stretches of one distribution.

namespace vesalius {
namespace {

// This is the lowest level at which zstd divides a column where its distribution changes. Level 9 takes 3 to 4 % more
// bytes, level 22 takes 0.1 % less.
constexpr int kColumnLevel = 16;
constexpr std::size_t kMaxTrees = 256;
constexpr std::size_t kWidestIndex = 5;  // bytes of a varint

// Where a child is: in depth-first order it is the next node or leaf not yet met; otherwise its index is stored among
// the far children.
enum Child : unsigned { kNextNode = 0, kNextLeaf = 1, kFarNode = 2, kFarLeaf = 3 };
constexpr unsigned kKindBits = 2;

using Number = std::int16_t TreeNode::*;
constexpr std::array kNumbers = {&TreeNode::du1, &TreeNode::dv1, &TreeNode::du2, &TreeNode::dv2,
                                 &TreeNode::threshold_mm};

/// Visits all nodes depth first and calls `follow(node, side, next)` for every child; side 0 is left, 1 is right.
/// `follow` returns whether the child is node `next`, the first node not yet met; if so, that node's children are
/// visited next. Nodes that no such child leads to are visited afterwards, each with its own descendants.
template <class Follow>
void each_child(std::size_t nodes, Follow&& follow) {
  std::vector<std::size_t> waiting;  // nodes whose right child is still to be visited
  for (std::size_t node = 0; node < nodes; ++node) {
    const auto next = static_cast<std::int32_t>(node + 1);
    if (follow(node, 0, next)) {
      waiting.push_back(node);
      continue;
    }
    for (std::size_t at = node; !follow(at, 1, next) && !waiting.empty(); waiting.pop_back()) at = waiting.back();
  }
}

constexpr int kAbsent = -1;  // context of an item that has no value in a column

/// The positions of a column's values after a stable sort by context (0 to 255).
class ContextOrder {
 public:
  template <class Items, class Context>
  ContextOrder(const Items& items, Context context) {
    for (const auto& item : items) {
      const int c = context(item);
      if (c != kAbsent) ++next_[c + 1];
    }
    for (std::size_t c = 1; c < next_.size(); ++c) next_[c] += next_[c - 1];
  }
  std::size_t size() const { return next_.back(); }
  std::size_t place(int context) { return next_[context]++; }

 private:
  std::array<std::size_t, 257> next_{};
};

int rest(const TreeLeaf& leaf, std::size_t slot) {
  int sum = 0;
  for (std::size_t k = 0; k < slot; ++k) sum += leaf.probability[k];
  return std::max(255 - sum, 0);
}

/// Returns the context of a probability. Probabilities descend and do not exceed what the earlier ones leave; since all
/// are multiples of 1/n for one n, the earlier ones tell even more.
int probability_context(const TreeLeaf& leaf, std::size_t slot) {
  if (slot == 0) return 0;
  const int before = leaf.probability[slot - 1];
  return slot == 1 ? before : std::min(before, rest(leaf, slot));
}

/// Returns the context of a label. Only slots in use have one.
int label_context(const TreeLeaf& leaf, std::size_t slot) {
  if (leaf.probability[slot] == 0) return kAbsent;
  return slot == 0 || leaf.probability[0] == 0 ? 0 : leaf.label[0];
}

/// Returns the context of a probe's offset. In every second pair one probe lies at the pixel itself.
int number_context(const TreeNode& node, Number number) { return number == &TreeNode::dv2 && node.du2 == 0 ? 1 : 0; }

/// Returns `value(item)` of all items, sorted by `context(item)`.
template <class Items, class Context, class Value>
std::string column(const Items& items, Context context, Value value) {
  ContextOrder order(items, context);
  std::string bytes(order.size(), '\0');
  for (const auto& item : items) {
    const int c = context(item);
    if (c != kAbsent) bytes[order.place(c)] = static_cast<char>(value(item));
  }
  return bytes;
}

/// Calls `set(item, byte)` for all items that have a value.
template <class Items, class Context, class Set>
void read_column(ByteReader& in, const char* what, Items& items, Context context, Set set) {
  ContextOrder order(items, context);
  const std::string bytes = read_packed(in, order.size(), order.size(), what);
  for (auto& item : items) {
    const int c = context(item);
    if (c != kAbsent) set(item, static_cast<std::uint8_t>(bytes[order.place(c)]));
  }
}

/// Returns the kinds of the children, one byte for each node. Indices that no kind expresses are appended to `far`.
std::string kinds_of(const Tree& tree, ByteWriter& far) {
  std::string kinds(tree.nodes.size(), '\0');
  std::int32_t next_leaf = 0;
  each_child(tree.nodes.size(), [&](std::size_t at, unsigned side, std::int32_t next_node) {
    const std::int32_t child = side == 0 ? tree.nodes[at].left : tree.nodes[at].right;
    Child kind = child >= 0 ? kFarNode : kFarLeaf;
    if (child == next_node) {
      kind = kNextNode;
    } else if (child == ~next_leaf) {
      kind = kNextLeaf;
      ++next_leaf;
    } else {
      far.varint(static_cast<std::uint32_t>(child >= 0 ? child : ~child));
    }
    kinds[at] = static_cast<char>(static_cast<unsigned char>(kinds[at]) | (kind << (side * kKindBits)));
    return kind == kNextNode;
  });
  return kinds;
}

void read_children(Tree& tree, std::string_view kinds, ByteReader& far) {
  std::int32_t next_leaf = 0;
  each_child(tree.nodes.size(), [&](std::size_t at, unsigned side, std::int32_t next_node) {
    const unsigned both = static_cast<unsigned char>(kinds[at]);
    if (both >> (2 * kKindBits) != 0) far.fail(fmt::format("node {}: unknown kind {}", at, both));
    const unsigned kind = (both >> (side * kKindBits)) & 3U;
    std::int32_t& child = side == 0 ? tree.nodes[at].left : tree.nodes[at].right;
    if (kind == kNextNode) {
      child = next_node;
    } else if (kind == kNextLeaf) {
      child = ~next_leaf++;
    } else {
      const std::uint32_t index = far.varint("child");
      if (index > static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max())) far.fail("child: out of range");
      child = kind == kFarNode ? static_cast<std::int32_t>(index) : ~static_cast<std::int32_t>(index);
    }
    return kind == kNextNode;
  });
}

/// Returns the columns in the order of the file. Where leaves have logits, their classes stay out of it: nothing reads
/// them.
std::vector<std::string> columns_of(const Tree& tree) {
  const std::vector<TreeLeaf> without_classes(tree.logits.empty() ? 0 : tree.leaves.size());
  const std::vector<TreeLeaf>& leaves = tree.logits.empty() ? tree.leaves : without_classes;
  ByteWriter far;
  std::vector<std::string> columns = {kinds_of(tree, far), std::move(far.bytes())};
  for (const Number number : kNumbers) {
    const auto context = [&](const TreeNode& node) { return number_context(node, number); };
    for (const unsigned shift : {0U, 8U}) {
      columns.push_back(
          column(tree.nodes, context, [&](const TreeNode& node) { return (zigzag(node.*number) >> shift) & 0xFFU; }));
    }
  }
  for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
    columns.push_back(column(
        leaves, [k](const TreeLeaf& leaf) { return probability_context(leaf, k); },
        [k](const TreeLeaf& leaf) { return leaf.probability[k]; }));
  }
  for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
    columns.push_back(column(
        leaves, [k](const TreeLeaf& leaf) { return label_context(leaf, k); },
        [k](const TreeLeaf& leaf) { return leaf.label[k]; }));
  }
  return columns;
}

std::string pack_tree(const Tree& tree) {
  std::string packed;
  for (const std::string& column : columns_of(tree)) packed += pack(column, kColumnLevel);
  return packed;
}

void read_numbers(ByteReader& in, std::vector<TreeNode>& nodes) {
  for (const Number number : kNumbers) {
    const auto context = [&](const TreeNode& node) { return number_context(node, number); };
    const std::string low = read_packed(in, nodes.size(), nodes.size(), "low bytes");
    const std::string high = read_packed(in, nodes.size(), nodes.size(), "high bytes");
    ContextOrder order(nodes, context);
    for (TreeNode& node : nodes) {
      const std::size_t at = order.place(context(node));
      const unsigned code =
          static_cast<unsigned char>(low[at]) | (static_cast<unsigned>(static_cast<unsigned char>(high[at])) << 8U);
      node.*number = static_cast<std::int16_t>(unzigzag(code));
    }
  }
}

void read_leaves(ByteReader& in, std::vector<TreeLeaf>& leaves) {
  for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
    read_column(
        in, "probabilities", leaves, [k](const TreeLeaf& leaf) { return probability_context(leaf, k); },
        [k](TreeLeaf& leaf, std::uint8_t value) { leaf.probability[k] = value; });
  }
  for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
    read_column(
        in, "labels", leaves, [k](const TreeLeaf& leaf) { return label_context(leaf, k); },
        [k](TreeLeaf& leaf, std::uint8_t value) { leaf.label[k] = value; });
  }
}

/// Returns the logits of a tree, the first one of every leaf first.
std::string by_columns(const Tree& tree) {
  const std::size_t size = tree.logits.size() / tree.leaves.size();
  std::string columns(tree.logits.size(), '\0');
  for (std::size_t c = 0; c < size; ++c) {
    for (std::size_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
      columns[c * tree.leaves.size() + leaf] = static_cast<char>(tree.logits[leaf * size + c]);
    }
  }
  return columns;
}

struct PackedTree {
  std::size_t nodes, leaves;
  std::string_view bytes;
};

Tree unpack_tree(const PackedTree& packed, const std::string& name) {
  ByteReader in(packed.bytes, name);
  const std::string kinds = read_packed(in, packed.nodes, packed.nodes, "kinds of children");
  const std::string far_bytes = read_packed(in, 0, 2 * kWidestIndex * packed.nodes, "far children");
  const std::string far_name = name + ": far children";
  ByteReader far(far_bytes, far_name);
  Tree tree{std::vector<TreeNode>(packed.nodes), std::vector<TreeLeaf>(packed.leaves), {}};
  read_children(tree, kinds, far);
  far.expect_end();
  read_numbers(in, tree.nodes);
  read_leaves(in, tree.leaves);
  in.expect_end();
  return tree;
}

/// The numbers of nodes and leaves over all trees of a file.
struct Total {
  std::size_t nodes = 0, leaves = 0;

  void add(std::size_t more_nodes, std::size_t more_leaves) {
    nodes += more_nodes;
    leaves += more_leaves;
  }
  bool too_many() const { return nodes > kMaxModelNodes || leaves > kMaxModelNodes; }
  std::string message() const {
    return fmt::format("{} nodes and {} leaves, expected at most {} of either", nodes, leaves, kMaxModelNodes);
  }
};

std::vector<PackedTree> read_packed_trees(ByteReader& in) {
  const auto count = in.number<std::uint32_t>("trees");
  if (count > kMaxTrees) in.fail(fmt::format("{} trees, expected at most {}", count, kMaxTrees));
  std::vector<PackedTree> trees(count);
  Total total;
  for (PackedTree& tree : trees) {
    tree.nodes = in.number<std::uint32_t>("nodes");
    tree.leaves = in.number<std::uint32_t>("leaves");
    total.add(tree.nodes, tree.leaves);
    if (total.too_many()) in.fail(total.message());
    tree.bytes = in.text("tree");
  }
  return trees;
}

}  // namespace

void write_trees(ByteWriter& out, const std::vector<Tree>& trees) {
  Total total;
  for (const Tree& tree : trees) total.add(tree.nodes.size(), tree.leaves.size());
  if (total.too_many()) throw Error("forest: " + total.message());
  std::vector<std::string> packed(trees.size());
  parallel_for(int(trees.size()), [&](int t) { packed[t] = pack_tree(trees[t]); });
  out.number(static_cast<std::uint32_t>(trees.size()));
  for (std::size_t t = 0; t < trees.size(); ++t) {
    out.number(static_cast<std::uint32_t>(trees[t].nodes.size()));
    out.number(static_cast<std::uint32_t>(trees[t].leaves.size()));
    out.text(packed[t]);
  }
}

std::vector<Tree> read_trees(ByteReader& in) {
  const std::vector<PackedTree> packed = read_packed_trees(in);
  std::vector<Tree> trees(packed.size());
  parallel_for(int(trees.size()),
               [&](int t) { trees[t] = unpack_tree(packed[t], fmt::format("{}: tree {}", in.name(), t)); });
  return trees;
}

void write_logits(ByteWriter& out, const std::vector<Tree>& trees) {
  std::vector<std::string> packed(trees.size());
  parallel_for(int(trees.size()), [&](int t) { packed[t] = pack(by_columns(trees[t]), kColumnLevel); });
  for (const std::string& tree : packed) out.text(tree);
}

void read_logits(ByteReader& in, std::size_t size, std::vector<Tree>& trees) {
  std::vector<std::string_view> packed;
  for (std::size_t t = 0; t < trees.size(); ++t) packed.push_back(in.text("logits"));
  parallel_for(int(trees.size()), [&](int t) {
    const std::size_t count = trees[t].leaves.size();
    const std::string name = fmt::format("{}: logits of tree {}", in.name(), t);
    ByteReader bytes(packed[t], name);
    const std::string columns = read_packed(bytes, count * size, count * size, "logits");
    bytes.expect_end();
    trees[t].logits.resize(count * size);
    for (std::size_t c = 0; c < size; ++c) {
      for (std::size_t leaf = 0; leaf < count; ++leaf) {
        trees[t].logits[leaf * size + c] = static_cast<std::int8_t>(columns[c * count + leaf]);
      }
    }
  });
}

}  // namespace vesalius
