#include "vesalius/default_judge.h"

#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "vesalius/base/toml_reader.h"

namespace vesalius {
namespace {

constexpr std::array<const char*, 2> kDefaultJudges
#include "default_judge.inc"
    ;

constexpr double kMost = 1e6;
constexpr int kMostFeatures = 10000;

template <std::size_t count>
std::array<float, count> numbers(const TomlReader& reader, const toml::table& table, std::string_view key) {
  const toml::array& values = reader.array(table, key);
  if (values.size() != count)
    reader.fail(values, std::string(key) + ": expected " + std::to_string(count) + " numbers");
  std::array<float, count> read{};
  for (std::size_t i = 0; i < count; ++i) read[i] = reader.number(values[i], key, -kMost, kMost);
  return read;
}

BoostedTree read_tree(const TomlReader& reader, const toml::table& table, const std::vector<std::string>& asks) {
  reader.expect_keys(table, {"asks", "above", "value"});
  BoostedTree tree;
  const toml::array& names = reader.array(table, "asks");
  if (names.size() != tree.feature.size()) reader.fail(names, "asks: expected a name for each of 15 nodes");
  tree.threshold = numbers<BoostedTree::kNodes>(reader, table, "above");
  tree.value = numbers<BoostedTree::kLeaves>(reader, table, "value");
  for (std::size_t n = 0; n < tree.feature.size(); ++n) {
    const std::string name = reader.string(names[n], "asks");
    if (name.empty()) {  // it does not split
      tree.threshold[n] = std::numeric_limits<float>::infinity();
      continue;
    }
    const auto found = std::ranges::find(asks, name);
    if (found == asks.end()) reader.fail(names[n], "asks for " + in_quotes(name) + ", which is not in the list of all");
    tree.feature[n] = static_cast<std::uint16_t>(found - asks.begin());
  }
  return tree;
}

/// Writes what `text_of` gives for each item as an array.
template <class Items, class Text>
void write_array(std::ostream& out, const char* key, const Items& items, const Text& text_of) {
  out << key << " = [";
  for (std::size_t i = 0; i < items.size(); ++i) {
    out << (i > 0 ? ", " : "");
    text_of(i);
  }
  out << "]\n";
}

}  // namespace

BoostedTrees parse_boosted_trees(std::string_view toml, const std::string& source) {
  const TomlReader reader(source);
  const toml::table root = reader.parse(toml);
  reader.expect_keys(root, {"asks", "bias", "tree"});
  BoostedTrees trees;
  for (const toml::node& name : reader.array(root, "asks")) trees.asks.push_back(reader.string(name, "asks"));
  trees.features = int(trees.asks.size());
  if (trees.features > kMostFeatures) reader.fail(root, "asks: too many names");
  trees.bias = reader.number(root, "bias", -kMost, kMost);
  for (const toml::node& tree : reader.array(root, "tree")) {
    trees.trees.push_back(read_tree(reader, reader.table(tree, "tree"), trees.asks));
  }
  return trees;
}

std::string to_toml(const BoostedTrees& trees) {
  std::ostringstream out;
  out.precision(std::numeric_limits<float>::max_digits10);
  out << std::showpoint;
  write_array(out, "asks", trees.asks, [&](std::size_t i) { out << '"' << trees.asks[i] << '"'; });
  out << "bias = " << trees.bias << '\n';
  for (const BoostedTree& tree : trees.trees) {
    const auto splits = [&](std::size_t n) { return std::isfinite(tree.threshold[n]); };
    out << "\n[[tree]]\n";
    write_array(out, "asks", tree.feature,
                [&](std::size_t n) { out << '"' << (splits(n) ? trees.asks[tree.feature[n]] : "") << '"'; });
    write_array(out, "above", tree.threshold, [&](std::size_t n) { out << (splits(n) ? tree.threshold[n] : 0.F); });
    write_array(out, "value", tree.value, [&](std::size_t i) { out << tree.value[i]; });
  }
  return out.str();
}

const BoostedTrees& default_judge() {
  static const BoostedTrees kJudge = parse_boosted_trees(kDefaultJudges[0], "default judge");
  return kJudge;
}

const BoostedTrees& default_judge_of_cut_outs() {
  static const BoostedTrees kJudge = parse_boosted_trees(kDefaultJudges[1], "default judge of cut-outs");
  return kJudge;
}

}  // namespace vesalius
