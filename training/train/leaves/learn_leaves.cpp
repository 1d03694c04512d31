#include "train/leaves/learn_leaves.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr int kLeafGrain = 1024;
constexpr int kSavedRounds = 4;  ///< rounds from one that is saved to the next
/// Samples for which the shares that a leaf has from growing count where its logits start.
constexpr float kOwnSamples = 100.F;
constexpr float kLargestStep = 0.5F;  ///< largest step of a logit in one round, nats
/// Unit of logits in a file, nats: rounding over eight trees then adds about 0.2. Half of it makes files a sixth
/// larger.
constexpr float kLogitUnit = 1.F / 4.F;
constexpr float kLargestLogit = 16.F;  ///< nats

/// Returns weights in proportion to counts to the power of -balance, with a mean of 1 over all that are counted.
std::vector<double> balanced(const std::int64_t* counts, std::size_t size, float balance) {
  std::vector<double> weights(size, 0.0);
  double sum = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    if (counts[i] == 0) continue;
    const auto count = double(counts[i]);
    weights[i] = std::pow(count, -double(balance));
    sum += count * weights[i];
    all += count;
  }
  for (double& weight : weights) weight *= sum > 0.0 ? all / sum : 0.0;
  return weights;
}

std::int32_t in_units(double weight) {
  return static_cast<std::int32_t>(std::lround(std::clamp(weight, 0.0, 64.0) * SampleWeights::kUnit));
}

SampleWeights weights_of(const LabelCounts& counts, const LogitLayout& layout, const LeafLearningOptions& options) {
  SampleWeights weights;
  for (const double w : balanced(counts.classes.data(), layout.parts, options.part_balance)) {
    weights.of_class.push_back(std::max(1, in_units(w)));
  }
  if (layout.background) weights.of_class.push_back(in_units(double(options.background_weight)));
  for (const double w : balanced(counts.headings.data(), counts.headings.size(), options.heading_balance)) {
    weights.of_heading.push_back(std::max(1, in_units(w)));
  }
  return weights;
}

/// Learns all logits of a forest by damped Newton steps of every logit for itself.
class LeafLearner {
 public:
  LeafLearner(LeafExecutor& shards, const Forest& forest, const LogitLayout& layout, const LeafLearningOptions& options)
      : shards_(shards), layout_(layout), options_(options), forest_(forest), trees_(forest.trees.size()) {
    logits_.stride = padded_size(layout);
  }

  LeafLogits run(TreeStore& store, const LeafRoundEnd& end_round) {
    shards_.set_weights(weights_of(shards_.label_counts(), layout_, options_));
    start();
    int round = 0;
    if (std::optional<LeafState> saved = store.load_leaves(); saved && fits(*saved)) {
      round = saved->rounds;
      logits_ = std::move(saved->logits);
    }
    for (; round < options_.rounds; ++round) {
      const GradientTask task{round % options_.portions, options_.portions, shift_};
      const LeafGradient gradient = shards_.gradient(logits_, task);
      for (std::size_t t = 0; t < trees_; ++t) step(t, gradient.of_trees[t]);
      const bool go_on = end_round(round, std::exp(gradient.log_likelihood / std::max(gradient.weight, 1e-9)));
      const bool last = round + 1 == options_.rounds;
      if (!go_on || last || (round + 1) % kSavedRounds == 0) store.save_leaves({round + 1, logits_});
      if (!go_on && !last) throw Interrupted("interrupted while leaves were learned");
    }
    return std::move(logits_);
  }

 private:
  bool fits(const LeafState& saved) const {
    if (saved.logits.stride != logits_.stride || saved.logits.of_trees.size() != trees_) return false;
    for (std::size_t t = 0; t < trees_; ++t) {
      if (saved.logits.of_trees[t].size() != logits_.of_trees[t].size()) return false;
    }
    return true;
  }

  /// Sets the logits to start with: the prior's logarithm, divided among the trees, and a share of how much more likely
  /// than that the leaf's samples are.
  void start() {
    double largest = 1.0;
    for (std::size_t t = 0; t < trees_; ++t) {
      const LeafCounts counts = shards_.leaf_counts(int(t));
      const std::size_t size = layout_.size();
      const std::size_t leaves = counts.weights.size() / size;
      if (t == 0) set_prior(counts, leaves);
      counts_.emplace_back(leaves * size);
      logits_.of_trees.emplace_back(leaves * logits_.stride, std::int16_t{0});
      for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
        float* row = counts_[t].data() + leaf * size;
        for (std::size_t c = 0; c < size; ++c) {
          row[c] = float(double(counts.weights[leaf * size + c]) / SampleWeights::kOne);
        }
        largest = std::max(largest, double(weight_of(row)));
        std::int16_t* logits = logits_.of_trees[t].data() + leaf * logits_.stride;
        std::vector<float> begin_with(row, row + size);
        for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
          const TreeLeaf& own = forest_.trees[t].leaves[leaf];
          begin_with[own.label[k]] += kOwnSamples * float(own.probability[k]) / 255.F;
        }
        for_groups([&](std::size_t begin, std::size_t end) { start_group(begin_with.data(), logits, begin, end); });
      }
      start_.push_back(logits_.of_trees[t]);
    }
    shift_ = std::clamp(30 - int(std::ceil(std::log2(2.0 * largest))), 0, 14);
  }

  /// Calls `use(begin, end)` for the classes and for the headings of each side.
  template <class Use>
  void for_groups(const Use& use) const {
    use(0, static_cast<std::size_t>(layout_.classes()));
    if (layout_.headings == 0) return;
    for (int s = 0; s < kSides; ++s) {
      use(static_cast<std::size_t>(layout_.turn(s, 0)), static_cast<std::size_t>(layout_.turn(s, layout_.headings)));
    }
  }

  void set_prior(const LeafCounts& counts, std::size_t leaves) {
    const std::size_t size = layout_.size();
    prior_.assign(size, 0.0);
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
      for (std::size_t c = 0; c < size; ++c) prior_[c] += double(counts.weights[leaf * size + c]) / SampleWeights::kOne;
    }
    for_groups([&](std::size_t begin, std::size_t end) {
      double sum = 0.0;
      for (std::size_t c = begin; c < end; ++c) sum += prior_[c] += 1e-3;
      for (std::size_t c = begin; c < end; ++c) prior_[c] /= sum;
    });
  }

  void start_group(const float* counts, std::int16_t* logits, std::size_t begin, std::size_t end) const {
    constexpr double kStrength = 4.0;  // of the prior in the leaf's shares, in samples
    double sum = kStrength;
    for (std::size_t c = begin; c < end; ++c) sum += double(counts[c]);
    for (std::size_t c = begin; c < end; ++c) {
      const double share = (double(counts[c]) + kStrength * prior_[c]) / sum;
      const double logit = std::log(prior_[c]) / double(trees_) + double(options_.lift) * std::log(share / prior_[c]);
      logits[c] = stored(float(logit));
    }
  }

  static std::int16_t stored(float logit) {
    return static_cast<std::int16_t>(std::lround(std::clamp(logit, -kLargestLogit, kLargestLogit) / LeafLogits::kUnit));
  }

  float weight_of(const float* counts) const {
    float sum = 0.F;
    for (int c = 0; c < layout_.classes(); ++c) sum += counts[c];
    return sum;
  }

  void step(std::size_t t, const std::vector<std::int32_t>& gradient) {
    const std::size_t size = layout_.size();
    const float unit = std::ldexp(1.F, -shift_);
    const float share = 1.F / float(options_.portions);
    const float prior = options_.prior * share;
    const float together = float(trees_) * (layout_.headings > 0 ? 2.F : 1.F);
    const float part = options_.step / together;
    const auto leaves = int(gradient.size() / logits_.stride);
    parallel_ranges(leaves, kLeafGrain, [&](int begin, int end) {
      for (int leaf = begin; leaf < end; ++leaf) {
        const float* counts = counts_[t].data() + leaf * size;
        const float all = std::max(weight_of(counts) * share, 1e-6F);
        for (std::size_t c = 0; c < size; ++c) {
          const std::size_t at = leaf * logits_.stride + c;
          const float g = float(gradient[at]) * unit;
          const float expected = std::clamp(counts[c] * share - g, 0.F, all);
          const float now = float(logits_.of_trees[t][at]) * LeafLogits::kUnit;
          const float from_start = now - float(start_[t][at]) * LeafLogits::kUnit;
          const float curvature = expected * (1.F - expected / all) + prior;
          const float change = part * (g - prior * from_start) / curvature;
          logits_.of_trees[t][at] = stored(now + std::clamp(change, -kLargestStep, kLargestStep));
        }
      }
    });
  }

  LeafExecutor& shards_;
  const LogitLayout& layout_;
  const LeafLearningOptions& options_;
  const Forest& forest_;
  std::size_t trees_;
  int shift_ = 0;
  std::vector<double> prior_;
  std::vector<std::vector<float>> counts_;
  std::vector<std::vector<std::int16_t>> start_;
  LeafLogits logits_;
};

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSteps = 600;
constexpr double kPrior = 2e-3;  ///< strength of the prior: of squared weights, for features of standard deviation 1

/// Divides each row by its sum after taking exponentials.
void softmax(MatrixXd& logits) {
  for (Index i = 0; i < logits.rows(); ++i) {
    logits.row(i) = (logits.row(i).array() - logits.row(i).maxCoeff()).exp();
    logits.row(i) /= logits.row(i).sum();
  }
}

}  // namespace

void visit_options(const std::string& prefix, LeafLearningOptions& options, OptionVisitor& visitor) {
  visitor.option(prefix + "leaf-rounds", options.rounds,
                 {"", 0, 10000, "Rounds of learning all leaves together; 0: each leaf keeps its own shares"});
  visitor.option(prefix + "leaf-headings", options.headings,
                 {"", 0, kHeadings, "Headings of a person that leaves tell apart: 8, or 0 for none"});
  visitor.option(prefix + "leaf-portions", options.portions,
                 {"", 1, 1000, "Parts of the frames, of which each round looks at one"});
  visitor.option(prefix + "leaf-step", options.step,
                 {"", 0.001, 2, "Share of Newton's step that all logits of a sample take together"});
  visitor.option(prefix + "leaf-prior", options.prior,
                 {"samples", 0, 1000, "Weight with which logits stay where they started"});
  visitor.option(prefix + "leaf-lift", options.lift, {"", 0, 1, "Share of a leaf's evidence to start with"});
  visitor.option(prefix + "leaf-part-balance", options.part_balance,
                 {"", 0, 1, "How far samples of rare parts count more; 1: all parts alike"});
  visitor.option(prefix + "leaf-background", options.background_weight,
                 {"", 0, 64, "What samples of the background count"});
  visitor.option(prefix + "leaf-heading-balance", options.heading_balance,
                 {"", 0, 1, "How far samples of rare headings count more; 1: all headings alike"});
}

LeafLogits learn_leaves(LeafExecutor& shards, const Forest& forest, const LogitLayout& layout,
                        const LeafLearningOptions& options, TreeStore& store, const LeafRoundEnd& end_round) {
  return LeafLearner(shards, forest, layout, options).run(store, end_round);
}

void set_logits(Forest& forest, const LogitLayout& layout, const LeafLogits& logits) {
  forest.headings = layout.headings;
  forest.logit_unit = kLogitUnit;
  const std::size_t size = layout.size();
  for (std::size_t t = 0; t < forest.trees.size(); ++t) {
    Tree& tree = forest.trees[t];
    tree.logits.resize(tree.leaves.size() * size);
    for (std::size_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
      for (std::size_t c = 0; c < size; ++c) {
        const float nats = float(logits.of_trees[t][leaf * logits.stride + c]) * LeafLogits::kUnit;
        tree.logits[leaf * size + c] = static_cast<std::int8_t>(std::lround(nats / forest.logit_unit));
      }
    }
  }
}

FacingModel fit_facing(const std::vector<FacingSample>& samples, int parts, int headings) {
  FacingModel model{headings, parts, {}};
  if (headings == 0 || samples.empty()) return model;
  std::vector<double> count(headings, 0.0);
  for (const FacingSample& sample : samples) count[sample.heading] += 1.0;
  if (std::ranges::any_of(count, [](double n) { return n == 0.0; })) return model;
  const auto people = static_cast<Index>(samples.size());
  const auto features = static_cast<Index>(model.features());
  MatrixXd x(people, features);
  MatrixXd truth = MatrixXd::Zero(people, headings);
  VectorXd weight(people);
  for (Index i = 0; i < people; ++i) {
    const std::vector<float>& of_person = samples[i].features;
    x.row(i) = Eigen::Map<const Eigen::RowVectorXf>(of_person.data(), features).cast<double>();
    truth(i, samples[i].heading) = 1.0;
    weight[i] = 1.0 / std::sqrt(count[samples[i].heading]);
  }
  weight /= weight.sum();
  VectorXd scale = (x.array().square().colwise().sum() / double(people)).sqrt().transpose();
  for (Index f = 0; f < features; ++f) scale[f] = scale[f] > 1e-6 ? 1.0 / scale[f] : 0.0;
  x = x * scale.asDiagonal();
  // Gradient descent with Nesterov's momentum; a softmax's curvature is at most half of the features' largest variance.
  const double curvature = 0.5 * (x.transpose() * weight.asDiagonal() * x).norm() + kPrior;
  MatrixXd w = MatrixXd::Zero(features, headings);
  MatrixXd ahead = w;
  for (int step = 0; step < kSteps; ++step) {
    MatrixXd error = x * ahead;
    softmax(error);
    error = weight.asDiagonal() * (error - truth);
    const MatrixXd next = ahead - (x.transpose() * error + kPrior * ahead) / curvature;
    ahead = next + (double(step) / (step + 3.0)) * (next - w);
    w = next;
  }
  w = scale.asDiagonal() * w;
  model.weights.resize(static_cast<std::size_t>(features) * headings);
  for (int h = 0; h < headings; ++h) {
    for (Index f = 0; f < features; ++f) model.weights[h * features + f] = float(w(f, h));
  }
  return model;
}

}  // namespace vesalius
