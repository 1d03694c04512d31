#include "vesalius/boosted_trees.h"

#include <algorithm>
#include <cmath>

#include "vesalius/base/logistic.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

float value_at(const BoostedTree& tree, const float* of) {
  int node = 0;
  for (int level = 0; level < BoostedTree::kDepth; ++level) {
    node = 2 * node + 1 + (of[tree.feature[node]] > tree.threshold[node] ? 1 : 0);
  }
  return tree.value[node - BoostedTree::kNodes];
}

}  // namespace

void BoostedTrees::log_odds(const float* of, std::size_t count, float* out) const {
  std::fill_n(out, count, bias);
  const auto length = static_cast<std::size_t>(features);
  for (const BoostedTree& tree : trees) {
    for (std::size_t i = 0; i < count; ++i) out[i] += value_at(tree, of + i * length);
  }
}

float BoostedTrees::probability(const std::vector<float>& of) const {
  float sum = 0.F;
  log_odds(of.data(), 1, &sum);
  return logistic(sum);
}

BoostedTrees in_order(BoostedTrees trees, const std::vector<std::string>& names, const std::string& what) {
  if (trees.asks.empty()) {
    if (static_cast<std::size_t>(trees.features) == names.size()) return trees;
    throw Error("forest: its " + what + " knows " + std::to_string(trees.features) + " features, expected " +
                std::to_string(names.size()) + "; fit it a new one");
  }
  std::vector<std::uint16_t> place;
  for (const std::string& asked : trees.asks) {
    const auto found = std::ranges::find(names, asked);
    if (found == names.end()) {
      throw Error("forest: its " + what + " asks for \"" + asked + "\", which this program does not know");
    }
    place.push_back(static_cast<std::uint16_t>(found - names.begin()));
  }
  for (BoostedTree& tree : trees.trees) {
    for (std::uint16_t& feature : tree.feature) feature = place[feature];
  }
  trees.features = int(names.size());
  trees.asks = names;
  return trees;
}

void check(const BoostedTrees& trees, const std::string& what) {
  if (!trees.asks.empty() && trees.asks.size() != static_cast<std::size_t>(trees.features)) {
    throw Error("forest: " + what + " has " + std::to_string(trees.asks.size()) + " names of " +
                std::to_string(trees.features) + " features");
  }
  bool finite = std::isfinite(trees.bias);
  for (const BoostedTree& tree : trees.trees) {
    if (std::ranges::any_of(tree.feature, [&](std::uint16_t f) { return f >= trees.features; })) {
      throw Error("forest: " + what + " asks for a feature that it does not have");
    }
    finite = finite && std::ranges::none_of(tree.threshold, [](float t) { return std::isnan(t); }) &&
             std::ranges::all_of(tree.value, [](float v) { return std::isfinite(v); });
  }
  if (!finite) throw Error("forest: " + what + " has a number that is none");
}

}  // namespace vesalius
