#include "learn/fit_vote_judge.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "learn/fit_boosted.h"
#include "learn/fit_tracks.h"
#include "vesalius/score_person.h"

namespace vesalius {
namespace {

/// What the judge asks for.
constexpr std::array<std::string_view, 10> kAsked{"votes",   "spread",     "likely",    "agree", "groups",
                                                  "lacking", "likelihood", "explained", "size",  "near"};
constexpr double kFarthest = 4.0;    ///< standard deviations from the mean, beyond which nothing changes
constexpr double kSquare = 0.3;      ///< by which squares are scaled, so that the ridge weighs them more
constexpr double kRidge = 3.0;       ///< on weights, in samples
constexpr double kFalseCosts = 3.0;  ///< people that a false one costs, besides RefineOptions::min_score
constexpr int kStaircases = 4;       ///< trees of each kind of evidence, whose steps lie between each other's

/// One kind of evidence over all samples.
struct Asked {
  std::size_t feature = 0;
  double mean = 0.0, deviation = 1.0;
  std::vector<double> sorted;  ///< values of all samples

  double standard(double x) const { return std::clamp((x - mean) / deviation, -kFarthest, kFarthest); }
};

Asked asked_of(const std::vector<BoostSample>& samples, std::size_t feature) {
  Asked asked;
  asked.feature = feature;
  for (const BoostSample& sample : samples) asked.sorted.push_back(double(sample.features[feature]));
  std::ranges::sort(asked.sorted);
  const auto count = double(samples.size());
  double sum = 0.0, squares = 0.0;
  for (const double x : asked.sorted) sum += x;
  asked.mean = sum / count;
  for (const double x : asked.sorted) squares += (x - asked.mean) * (x - asked.mean);
  asked.deviation = std::sqrt(squares / count) + 1e-6;
  return asked;
}

/// Returns the weights, for each kind of evidence that of its standard value and of its square.
LogisticFit regress(const std::vector<BoostSample>& samples, const std::vector<Asked>& asked) {
  const auto count = Eigen::Index(samples.size());
  Eigen::MatrixXd known(Eigen::Index(2 * asked.size()), count);
  Eigen::VectorXd answer(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const BoostSample& sample = samples[std::size_t(i)];
    answer[i] = sample.positive ? 1.0 : 0.0;
    for (std::size_t a = 0; a < asked.size(); ++a) {
      const double x = asked[a].standard(double(sample.features[asked[a].feature]));
      known(Eigen::Index(2 * a), i) = x;
      known(Eigen::Index(2 * a + 1), i) = kSquare * x * x;
    }
  }
  return fit_standard_logistic(known, answer, Eigen::VectorXd::Ones(count), kRidge);
}

/// Writes thresholds in ascending order to the nodes of a tree, so that leaf l takes what is between two of them.
void place_thresholds(const std::vector<float>& ascending, std::size_t begin, std::size_t end, std::size_t node,
                      BoostedTree& tree) {
  if (begin >= end) return;
  const std::size_t middle = (begin + end) / 2;
  tree.threshold[node] = ascending[middle];
  place_thresholds(ascending, begin, middle, 2 * node + 1, tree);
  place_thresholds(ascending, middle + 1, end, 2 * node + 2, tree);
}

/// Returns a part of the staircase that rises as a linear and a square weight say, with steps at every kStaircases-th
/// of evenly many samples.
BoostedTree staircase(const Asked& asked, double linear, double square, int number) {
  BoostedTree tree;
  tree.feature.fill(static_cast<std::uint16_t>(asked.feature));
  constexpr int steps = kStaircases * BoostedTree::kLeaves;
  const std::size_t last = asked.sorted.size() - 1;
  const auto quantile = [&](double step) { return asked.sorted[std::size_t(step / steps * double(last))]; };
  std::vector<float> thresholds;
  for (int n = 1; n <= BoostedTree::kNodes; ++n) thresholds.push_back(float(quantile(kStaircases * n + number - 1)));
  place_thresholds(thresholds, 0, thresholds.size(), 0, tree);
  for (int leaf = 0; leaf < BoostedTree::kLeaves; ++leaf) {
    const double first = std::max(0, kStaircases * leaf + number - 1);
    const double beyond = std::min(steps, kStaircases * (leaf + 1) + number - 1);
    const double x = asked.standard(quantile(0.5 * (first + beyond)));
    tree.value[leaf] = float((linear * x + square * kSquare * x * x) / kStaircases);
  }
  return tree;
}

}  // namespace

BoostedTrees fit_vote_judge(const std::vector<BoostSample>& samples, const BodyModel& body) {
  expect_people_and_nobodies(samples);
  const std::vector<std::string> names = judge_names(body);
  std::vector<Asked> asked;
  asked.reserve(kAsked.size());
  for (const std::string_view name : kAsked) {
    asked.push_back(asked_of(samples, std::size_t(std::ranges::find(names, name) - names.begin())));
  }
  const LogisticFit fit = regress(samples, asked);
  BoostedTrees judge;
  judge.features = int(names.size());
  judge.bias = float(fit.bias - std::log(kFalseCosts));
  judge.asks = names;
  for (std::size_t a = 0; a < asked.size(); ++a) {
    for (int number = 0; number < kStaircases; ++number) {
      judge.trees.push_back(
          staircase(asked[a], fit.weights[Eigen::Index(2 * a)], fit.weights[Eigen::Index(2 * a + 1)], number));
    }
  }
  return judge;
}

}  // namespace vesalius
