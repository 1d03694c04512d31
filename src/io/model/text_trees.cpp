#include "io/model/text_trees.h"

#include <bzlib.h>
#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

#include "io/files/data_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr int kMaxHeight = 22;                               // the released trees have 20
constexpr std::size_t kMaxTextBytes = std::size_t{1} << 28;  // 256 MiB; the released trees have 25
constexpr int kUndecided = -1;

/// The complete binary tree of the text. The children of node i are 2i+1 and 2i+2; leaves follow the nodes.
struct LevelOrder {
  std::vector<TreeNode> nodes;
  std::vector<std::uint8_t> labels;

  std::size_t size() const { return nodes.size() + labels.size(); }
  /// Returns the child that every pixel takes, if there is only one: both probes are equal, so the feature is always 0.
  std::optional<std::size_t> only_child(std::size_t i) const {
    const TreeNode& node = nodes[i];
    if (node.du1 != node.du2 || node.dv1 != node.dv2) return std::nullopt;
    return node.threshold_mm >= 0 ? 2 * i + 1 : 2 * i + 2;
  }
};

class NumberScanner {
 public:
  NumberScanner(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  [[noreturn]] void fail(const std::string& what) const { throw Error(fmt::format("{}:{}: {}", name_, line_, what)); }
  bool at_end() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') {
        ++line_;
      } else if (c != ' ' && c != '\t' && c != '\r') {
        return false;
      }
    }
    return true;
  }
  int next(int low, int high, const char* what) {
    if (at_end()) fail(fmt::format("expected {}, found the end of the file", what));
    int value = 0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc() || value < low || value > high) {
      fail(fmt::format("{}: expected a whole number from {} to {}", what, low, high));
    }
    at_ = end - text_.data();
    return value;
  }

 private:
  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 1;
};

LevelOrder read_level_order(std::string_view text, const std::string& name) {
  NumberScanner in(text, name);
  const int height = in.next(0, kMaxHeight, "height of the tree");
  const std::size_t leaves = std::size_t{1} << height;
  // A node takes at least ten bytes of text and a label two, so nothing larger than the text can fill is allocated.
  if (text.size() + 9 < 12 * leaves) {
    in.fail(fmt::format("{} bytes are too few for a tree of height {}", text.size(), height));
  }
  LevelOrder tree;
  tree.nodes.resize(leaves - 1);
  tree.labels.resize(leaves);
  constexpr int kMaxThreshold = std::numeric_limits<std::int16_t>::max();
  for (TreeNode& node : tree.nodes) {
    for (std::int16_t* offset : {&node.du1, &node.dv1, &node.du2, &node.dv2}) {
      *offset = static_cast<std::int16_t>(in.next(-kMaxOffset, kMaxOffset, "offset"));
    }
    node.threshold_mm = static_cast<std::int16_t>(in.next(-kMaxThreshold, kMaxThreshold, "threshold"));
  }
  for (std::uint8_t& label : tree.labels) label = static_cast<std::uint8_t>(in.next(0, kBackground - 1, "label"));
  if (!in.at_end()) in.fail("expected the end of the file after the last label");
  return tree;
}

/// Returns for every node and leaf the label that all pixels reaching it get, or `kUndecided` if they differ.
std::vector<std::int16_t> decide(const LevelOrder& tree) {
  std::vector<std::int16_t> decided(tree.size(), kUndecided);
  for (std::size_t i = tree.size(); i-- > 0;) {
    if (i >= tree.nodes.size()) {
      decided[i] = tree.labels[i - tree.nodes.size()];
    } else if (const auto only = tree.only_child(i)) {
      decided[i] = decided[*only];
    } else if (decided[2 * i + 1] == decided[2 * i + 2]) {
      decided[i] = decided[2 * i + 1];
    }
  }
  return decided;
}

/// Copies the tree without the removed branches, level by level. All leaves with the same label become one.
class Pruner {
 public:
  explicit Pruner(const LevelOrder& from) : from_(from), decided_(decide(from)) {}

  Tree prune() {
    place(0);
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      const std::size_t i = origin_[n];
      const std::int32_t left = place(2 * i + 1);
      const std::int32_t right = place(2 * i + 2);
      tree_.nodes[n].left = left;
      tree_.nodes[n].right = right;
    }
    return std::move(tree_);
  }

 private:
  /// Returns the index of the node or leaf that stands for `i` in the new tree.
  std::int32_t place(std::size_t i) {
    while (decided_[i] == kUndecided) {
      const auto only = from_.only_child(i);
      if (!only) break;
      i = *only;
    }
    if (decided_[i] != kUndecided) return ~leaf(static_cast<std::uint8_t>(decided_[i]));
    origin_.push_back(i);
    tree_.nodes.push_back(from_.nodes[i]);
    return static_cast<std::int32_t>(tree_.nodes.size() - 1);
  }

  std::int32_t leaf(std::uint8_t label) {
    for (std::size_t l = 0; l < tree_.leaves.size(); ++l) {
      if (tree_.leaves[l].label[0] == label) return static_cast<std::int32_t>(l);
    }
    TreeLeaf& added = tree_.leaves.emplace_back();
    added.label[0] = label;
    added.probability[0] = 255;
    return static_cast<std::int32_t>(tree_.leaves.size() - 1);
  }

  const LevelOrder& from_;
  std::vector<std::int16_t> decided_;
  std::vector<std::size_t> origin_;  ///< for each new node its index in `from_`
  Tree tree_;
};

/// Decompresses all streams of a bzip2 file, one after the other, as bunzip2 does.
std::string decompress_bz2(std::string_view packed, const std::string& name) {
  const auto fail = [&](const std::string& what) { throw Error(name + ": " + what); };
  std::string text;
  std::vector<char> block(1 << 18);
  while (!packed.empty()) {
    bz_stream stream{};
    if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) fail("bzip2 cannot start");
    const std::unique_ptr<bz_stream, int (*)(bz_stream*)> end(&stream, BZ2_bzDecompressEnd);
    stream.next_in = const_cast<char*>(packed.data());  // bzlib reads only
    stream.avail_in = static_cast<unsigned>(packed.size());
    int status = BZ_OK;
    while (status == BZ_OK) {
      stream.next_out = block.data();
      stream.avail_out = static_cast<unsigned>(block.size());
      status = BZ2_bzDecompress(&stream);
      text.append(block.data(), block.size() - stream.avail_out);
      if (text.size() > kMaxTextBytes) fail(fmt::format("unpacks to more than {} bytes", kMaxTextBytes));
      if (status == BZ_OK && stream.avail_in == 0 && stream.avail_out != 0) fail("truncated bzip2 data");
    }
    if (status != BZ_STREAM_END) fail("damaged bzip2 data");
    packed.remove_prefix(packed.size() - stream.avail_in);
  }
  return text;
}

}  // namespace

Tree parse_text_tree(std::string_view text, const std::string& name) {
  const LevelOrder complete = read_level_order(text, name);
  return Pruner(complete).prune();
}

Forest import_text_trees(const std::vector<std::string>& paths) {
  if (paths.empty()) throw Error("text trees: expected at least one file");
  Forest forest;
  forest.body = paper_body();
  forest.convention = {.offset_unit = 1.F, .reference_focal_px = 640.F};
  forest.recipe = "text trees:";
  for (const std::string& path : paths) {
    std::string text = read_file(path, kMaxTextBytes);
    if (text.starts_with("BZh")) text = decompress_bz2(text, path);
    forest.trees.push_back(parse_text_tree(text, path));
    // The labels are checked here because only here the body, and so the number of classes, is known.
    for (const TreeLeaf& leaf : forest.trees.back().leaves) {
      if (leaf.label[0] < forest.body.part_count()) continue;
      throw Error(fmt::format("{}: label {}, expected 0 to {}", path, leaf.label[0], forest.body.part_count() - 1));
    }
    forest.recipe.append(" ").append(std::filesystem::path(path).filename().string());
  }
  check(forest);
  return forest;
}

}  // namespace vesalius
