#include "vesalius/forest/boosted_trees.h"

#include <algorithm>
#include <cmath>

#include "vesalius/base/error.h"

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

float BoostedTrees::log_odds(const float* of) const {
  float sum = bias;
  for (const BoostedTree& tree : trees) sum += value_at(tree, of);
  return sum;
}

float BoostedTrees::probability(const std::vector<float>& of) const {
  return 1.F / (1.F + std::exp(-log_odds(of.data())));
}

void check(const BoostedTrees& trees, const std::string& what) {
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
