#include "vesalius/forest/person_judge.h"

#include <algorithm>
#include <cmath>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

float value_at(const JudgeTree& tree, const std::vector<float>& evidence) {
  int node = 0;
  while (node < JudgeTree::kNodes) node = 2 * node + (evidence[tree.feature[node]] > tree.threshold[node] ? 2 : 1);
  return tree.value[node - JudgeTree::kNodes];
}

}  // namespace

float PersonJudge::probability(const std::vector<float>& evidence) const {
  float sum = bias;
  for (const JudgeTree& tree : trees) sum += value_at(tree, evidence);
  return 1.F / (1.F + std::exp(-sum));
}

void check(const PersonJudge& judge) {
  bool finite = std::isfinite(judge.bias);
  for (const JudgeTree& tree : judge.trees) {
    if (std::ranges::any_of(tree.feature, [&](std::uint16_t f) { return f >= judge.features; })) {
      throw Error("forest: judge of people asks for evidence that it does not have");
    }
    finite = finite && std::ranges::none_of(tree.threshold, [](float t) { return std::isnan(t); }) &&
             std::ranges::all_of(tree.value, [](float v) { return std::isfinite(v); });
  }
  if (!finite) throw Error("forest: judge of people has a number that is none");
}

}  // namespace vesalius
