#include "learn/fit_boosted.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "vesalius/base/logistic.h"
#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/parallel.h"
#include "vesalius/score_person.h"

namespace vesalius {
namespace {

/// Neighbouring cells are alike, so leaves are large.
constexpr BoostOptions kContextOptions{
    .trees = 120, .rate = 0.1, .sample_share = 0.6, .feature_share = 0.4, .ridge = 10.0, .least_samples = 200};

/// Bodies' odds are so many times those that the samples have. A label is the background where that is likelier than
/// any single part, and a body's pixel has several likely parts; so the weights of the background stay what they are
/// for forests without context (docs/decisions/0037).
constexpr double kContextOdds = 7.0;

void expect_both(const std::vector<BoostSample>& samples, const std::string& none, const std::string& positive,
                 const std::string& negative) {
  const auto positives = std::ranges::count(samples, true, &BoostSample::positive);
  if (positives == 0) throw Error(none + positive);
  if (positives == std::ssize(samples)) throw Error(none + negative);
}

constexpr int kBins = 64;
constexpr std::uint64_t kSeed = 1;
constexpr float kNever = std::numeric_limits<float>::infinity();

/// First and second derivative of the loss, summed over samples.
struct Slope {
  double first = 0.0;
  double second = 0.0;
  int samples = 0;

  Slope& operator+=(const Slope& other) {
    first += other.first;
    second += other.second;
    samples += other.samples;
    return *this;
  }
};

/// The samples' values of one feature, in bins of about as many samples each.
struct Column {
  std::vector<float> thresholds;   ///< bin b holds what is above thresholds[b - 1] and not above thresholds[b]
  std::vector<std::uint8_t> bins;  ///< [sample]
};

Column column(const std::vector<BoostSample>& samples, std::size_t feature) {
  std::vector<float> sorted;
  sorted.reserve(samples.size());
  for (const BoostSample& sample : samples) sorted.push_back(sample.features[feature]);
  std::ranges::sort(sorted);
  Column column;
  for (std::size_t b = 1; b < kBins; ++b) {
    // Of many equal values, such as counts, all go into one bin, and the next one begins behind them.
    const float last = sorted[(b * sorted.size() - 1) / kBins];
    const auto next = std::ranges::upper_bound(sorted, last);
    if (next == sorted.end()) break;
    const float threshold = 0.5F * (last + *next);
    if (column.thresholds.empty() || threshold > column.thresholds.back()) column.thresholds.push_back(threshold);
  }
  for (const BoostSample& sample : samples) {
    const auto above = std::ranges::lower_bound(column.thresholds, sample.features[feature]);
    column.bins.push_back(static_cast<std::uint8_t>(above - column.thresholds.begin()));
  }
  return column;
}

/// The values that a leaf below a node may have, so that no later split breaks the order of an earlier one.
struct Bounds {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

struct Split {
  double gain = 0.0;
  int feature = -1;
  int bin = 0;  ///< this bin and those below go left
};

class Booster {
 public:
  Booster(const std::vector<BoostSample>& samples, std::vector<int> signs, const BoostOptions& options)
      : samples_(samples),
        signs_(std::move(signs)),
        options_(options),
        columns_(signs_.size()),
        slopes_(samples.size()) {
    parallel_for(int(columns_.size()), [&](int f) { columns_[f] = column(samples, f); });
    const auto people = double(std::ranges::count(samples, true, &BoostSample::positive));
    bias_ = std::log(people / (double(samples.size()) - people));
    log_odds_.assign(samples.size(), bias_);
  }

  BoostedTrees grow() {
    BoostedTrees grown{int(columns_.size()), float(bias_), {}};
    for (int t = 0; t < options_.trees; ++t) grown.trees.push_back(tree());
    return grown;
  }

 private:
  double value(const Slope& slope, const Bounds& bounds) const {
    return std::clamp(-slope.first / (slope.second + options_.ridge), bounds.low, bounds.high);
  }

  /// Returns by how much a node with this value lowers the loss.
  double gain(const Slope& slope, double value) const {
    return -(slope.first * value + 0.5 * (slope.second + options_.ridge) * value * value);
  }

  void draw() {
    drawn_.clear();
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (random_.uniform() >= options_.sample_share) continue;
      const double p = logistic(log_odds_[i]);
      slopes_[i] = {p - (samples_[i].positive ? 1.0 : 0.0), p * (1.0 - p), 1};
      drawn_.push_back(static_cast<std::uint32_t>(i));
    }
    asked_.clear();
    for (int f = 0; f < int(columns_.size()); ++f) {
      if (random_.uniform() < options_.feature_share) asked_.push_back(f);
    }
  }

  /// Returns the best split by one feature of each of the nodes of a level.
  std::vector<Split> splits(int feature, const std::vector<std::uint8_t>& node,
                            const std::vector<Bounds>& bounds) const {
    const Column& column = columns_[feature];
    const std::size_t nodes = bounds.size();
    std::vector<Slope> sums(nodes * kBins);
    for (const std::uint32_t i : drawn_) sums[node[i] * kBins + column.bins[i]] += slopes_[i];
    std::vector<Split> best(nodes);
    for (std::size_t n = 0; n < nodes; ++n) {
      Slope all;
      for (int b = 0; b < kBins; ++b) all += sums[n * kBins + b];
      const double whole = gain(all, value(all, bounds[n]));
      Slope left;
      for (std::size_t b = 0; b < column.thresholds.size(); ++b) {
        left += sums[n * kBins + b];
        const Slope right{all.first - left.first, all.second - left.second, all.samples - left.samples};
        if (std::min(left.samples, right.samples) < options_.least_samples) continue;
        const double below = value(left, bounds[n]), above = value(right, bounds[n]);
        if (signs_[feature] * (above - below) < 0.0) continue;
        const double better = gain(left, below) + gain(right, above) - whole;
        if (better > best[n].gain) best[n] = {better, feature, int(b)};
      }
    }
    return best;
  }

  /// Returns the values' bounds of the two children of a node.
  std::pair<Bounds, Bounds> children(const Bounds& bounds, const Split& split, const std::vector<std::uint8_t>& node,
                                     std::size_t n) const {
    std::pair<Bounds, Bounds> below{bounds, bounds};
    if (split.feature < 0 || signs_[split.feature] == 0) return below;
    Slope left, right;
    for (const std::uint32_t i : drawn_) {
      if (node[i] == n) (columns_[split.feature].bins[i] > split.bin ? right : left) += slopes_[i];
    }
    const double middle = 0.5 * (value(left, bounds) + value(right, bounds));
    (signs_[split.feature] > 0 ? below.first.high : below.first.low) = middle;
    (signs_[split.feature] > 0 ? below.second.low : below.second.high) = middle;
    return below;
  }

  BoostedTree tree() {
    draw();
    BoostedTree tree;
    tree.threshold.fill(kNever);
    std::vector<std::uint8_t> node(samples_.size(), 0);  // within its level
    std::vector<Bounds> bounds(1);
    for (int level = 0; level < BoostedTree::kDepth; ++level) {
      std::vector<std::vector<Split>> of_feature(asked_.size());
      parallel_for(int(asked_.size()), [&](int i) { of_feature[i] = splits(asked_[i], node, bounds); });
      std::vector<Split> best(bounds.size());
      for (const std::vector<Split>& found : of_feature) {
        for (std::size_t n = 0; n < best.size(); ++n) {
          if (found[n].gain > best[n].gain) best[n] = found[n];
        }
      }
      std::vector<Bounds> next;
      for (std::size_t n = 0; n < best.size(); ++n) {
        const auto [left, right] = children(bounds[n], best[n], node, n);
        next.insert(next.end(), {left, right});
        if (best[n].feature < 0) continue;
        const std::size_t at = bounds.size() - 1 + n;
        tree.feature[at] = static_cast<std::uint16_t>(best[n].feature);
        tree.threshold[at] = columns_[best[n].feature].thresholds[best[n].bin];
      }
      for (std::size_t i = 0; i < samples_.size(); ++i) {
        const Split& split = best[node[i]];
        const bool right = split.feature >= 0 && columns_[split.feature].bins[i] > split.bin;
        node[i] = static_cast<std::uint8_t>(2 * node[i] + (right ? 1 : 0));
      }
      bounds = std::move(next);
    }
    set_values(node, bounds, tree);
    return tree;
  }

  void set_values(const std::vector<std::uint8_t>& leaf, const std::vector<Bounds>& bounds, BoostedTree& tree) {
    std::vector<Slope> of_leaf(BoostedTree::kLeaves);
    for (const std::uint32_t i : drawn_) of_leaf[leaf[i]] += slopes_[i];
    for (int l = 0; l < BoostedTree::kLeaves; ++l) {
      tree.value[l] = float(options_.rate * value(of_leaf[l], bounds[l]));
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) log_odds_[i] += double(tree.value[leaf[i]]);
  }

  const std::vector<BoostSample>& samples_;
  std::vector<int> signs_;
  BoostOptions options_;
  std::vector<Column> columns_;
  std::vector<Slope> slopes_;         ///< [sample]; of those that the tree sees
  std::vector<std::uint32_t> drawn_;  ///< samples that the tree sees
  std::vector<double> log_odds_;
  std::vector<int> asked_;
  double bias_ = 0.0;
  Random random_{kSeed};
};

}  // namespace

BoostedTrees fit_context(const std::vector<BoostSample>& samples, const BodyModel& body) {
  expect_both(samples, "fitting the context: the frames have no pixel that may be a body and is known to be ", "one",
              "none");
  const std::vector<int> signs(samples.front().features.size(), 0);
  BoostedTrees context = boost_trees(samples, signs, kContextOptions);
  context.asks = BodySurroundings::feature_names(body);
  context.bias += float(std::log(kContextOdds));
  return context;
}

void expect_people_and_nobodies(const std::vector<BoostSample>& samples) {
  expect_both(samples, "fitting the judge: the frames have no candidate that is known to be ", "a person", "nobody");
}

BoostedTrees fit_judge(const std::vector<BoostSample>& samples, const BodyModel& body) {
  expect_people_and_nobodies(samples);
  BoostedTrees judge = boost_trees(samples, judge_signs(body));
  judge.asks = judge_names(body);
  return judge;
}

BoostedTrees boost_trees(const std::vector<BoostSample>& samples, const std::vector<int>& signs,
                         const BoostOptions& options) {
  const auto positive = std::ranges::count(samples, true, &BoostSample::positive);
  if (positive == 0 || positive == std::ranges::ssize(samples)) {
    throw Error("boosted trees: expected samples of both answers");
  }
  if (std::ranges::any_of(samples, [&](const BoostSample& s) { return s.features.size() != signs.size(); })) {
    throw Error("boosted trees: samples of different lengths");
  }
  return Booster(samples, signs, options).grow();
}

}  // namespace vesalius
