#include "train/leaves/leaf_shard.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "train/samples/walk_samples.h"
#include "vesalius/forest/facing.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// Samples whose gradients are held at a time; they stay in the cache.
constexpr std::size_t kBatch = 16384;

/// Returns whether a frame is in a portion.
bool in_portion(const TrainingSet& set, std::uint32_t frame, int portion, int portions) {
  return (frame + set.first_frame()) % static_cast<unsigned>(portions) == static_cast<unsigned>(portion);
}

}  // namespace

LeafShard::LeafShard(const TrainingSet& set, const Forest& forest, LogitLayout layout, const GradientTask& portion)
    : set_(set), samples_(set.samples()), layout_(std::move(layout)) {
  std::vector<const Tree*> trees;
  for (const Tree& tree : forest.trees) {
    trees.push_back(&tree);
    leaf_counts_.push_back(tree.leaves.size());
  }
  leaves_ = find_leaves(trees, set.frames(), samples_,
                        [&](std::uint32_t frame) { return in_portion(set, frame, portion.portion, portion.portions); });
}

LabelCounts count_labels(std::span<const TrainingSample> samples, const LogitLayout& layout) {
  LabelCounts counts{std::vector<std::int64_t>(layout.classes(), 0), std::vector<std::int64_t>(layout.headings, 0)};
  for (const TrainingSample& sample : samples) {
    ++counts.classes[sample.label];
    if (sample.heading < layout.headings) ++counts.headings[sample.heading];
  }
  return counts;
}

LeafCounts LeafShard::leaf_counts(int tree) const {
  const std::size_t size = layout_.size();
  LeafCounts counts{std::vector<std::int64_t>(leaf_counts_[tree] * size, 0)};
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const TrainingSample& sample = samples_[i];
    std::int64_t* row = counts.weights.data() + leaves_[tree][i] * size;
    const std::int64_t weight = weights_.of(sample);
    row[sample.label] += weight;
    if (sample.heading < layout_.headings) row[layout_.turn(layout_.side[sample.label], sample.heading)] += weight;
  }
  return counts;
}

/// The gradients of single samples, and their sums over leaves.
class LeafShard::Gradients {
 public:
  Gradients(const LeafShard& shard, const LeafLogits& logits, const GradientTask& task)
      : shard_(shard),
        logits_(logits),
        task_(task),
        softmax_(shard.layout_),
        scale_(std::ldexp(1.F, task.shift) / float(SampleWeights::kOne)),
        rows_(kBatch * logits.stride),
        likelihood_(kBatch) {
    for (const std::size_t leaves : shard.leaf_counts_) out_.of_trees.emplace_back(leaves * logits.stride, 0);
  }

  LeafGradient run() {
    for (std::size_t i = 0; i < shard_.samples_.size(); ++i) {
      if (!in_portion(shard_.set_, shard_.samples_[i].frame, task_.portion, task_.portions)) continue;
      batch_.push_back(static_cast<std::uint32_t>(i));
      if (batch_.size() == kBatch) flush();
    }
    flush();
    return std::move(out_);
  }

 private:
  void flush() {
    parallel_ranges(int(batch_.size()), 512, [&](int begin, int end) {
      std::vector<float> shares(logits_.stride);
      for (int k = begin; k < end; ++k) row_of(k, shares);
    });
    for (std::size_t k = 0; k < batch_.size(); ++k) {
      const double weight = shard_.weights_.of(shard_.samples_[batch_[k]]) / SampleWeights::kOne;
      out_.log_likelihood += weight * likelihood_[k];
      out_.weight += weight;
    }
    parallel_for(int(out_.of_trees.size()), [&](int t) { add_to_leaves(t); });
    batch_.clear();
  }

  void row_of(int k, std::vector<float>& shares) {
    const LogitLayout& layout = shard_.layout_;
    const std::size_t i = batch_[k];
    const TrainingSample& sample = shard_.samples_[i];
    std::int32_t* row = rows_.data() + k * logits_.stride;
    std::fill_n(row, logits_.stride, 0);
    for (std::size_t t = 0; t < shard_.leaves_.size(); ++t) {
      const std::int16_t* leaf = logits_.of_trees[t].data() + shard_.leaves_[t][i] * logits_.stride;
      for (std::size_t c = 0; c < logits_.stride; ++c) row[c] += leaf[c];
    }
    for (std::size_t c = 0; c < logits_.stride; ++c) shares[c] = float(row[c]) * LeafLogits::kUnit;
    softmax_(shares.data());
    const float weight = float(shard_.weights_.of(sample)) * scale_;
    likelihood_[k] = std::log(std::max(shares[sample.label], 1e-9F));
    const bool part = sample.label < layout.parts;
    const int side = part ? layout.side[sample.label] : 0;
    float of_side = 0.F;
    for (int h = 0; h < layout.headings; ++h) of_side += shares[layout.turn(side, h)];
    for (int c = 0; c < layout.classes(); ++c) {
      row[c] = static_cast<std::int32_t>(std::lround(weight * ((c == sample.label ? 1.F : 0.F) - shares[c])));
    }
    for (int s = 0; s < kSides; ++s) {
      for (int h = 0; h < layout.headings; ++h) {
        float truth = 0.F;
        if (part && s == side) {
          truth = sample.heading == kNoHeading ? shares[layout.turn(s, h)] / std::max(of_side, 1e-30F)
                                               : (h == sample.heading ? 1.F : 0.F);
        }
        row[layout.turn(s, h)] = static_cast<std::int32_t>(std::lround(weight * (truth - shares[layout.turn(s, h)])));
      }
    }
  }

  void add_to_leaves(int t) {
    std::vector<std::int32_t>& sums = out_.of_trees[t];
    const std::vector<std::uint32_t>& leaves = shard_.leaves_[t];
    for (std::size_t k = 0; k < batch_.size(); ++k) {
      std::int32_t* sum = sums.data() + leaves[batch_[k]] * logits_.stride;
      const std::int32_t* row = rows_.data() + k * logits_.stride;
      for (std::size_t c = 0; c < logits_.stride; ++c) sum[c] += row[c];
    }
  }

  const LeafShard& shard_;
  const LeafLogits& logits_;
  const GradientTask& task_;
  LogitSoftmax softmax_;
  float scale_;
  std::vector<std::uint32_t> batch_;
  std::vector<std::int32_t> rows_;
  std::vector<float> likelihood_;
  LeafGradient out_;
};

LeafGradient LeafShard::gradient(const LeafLogits& logits, const GradientTask& task) const {
  return Gradients(*this, logits, task).run();
}

std::vector<FacingSample> facing_samples(const TrainingSet& set, const Forest& forest) {
  std::vector<FacingSample> all(set.held_out_people().size());
  parallel_for(int(all.size()), [&](int i) {
    const PersonSamples& person = set.held_out_people()[i];
    SampleLogits logits(forest);
    FacingEvidence evidence(logits.layout().parts, logits.layout().headings);
    std::vector<std::uint16_t> posteriors(logits.layout().classes());
    for (std::uint32_t k = person.begin; k < person.end; ++k) {
      logits.read(set.frames(), set.people_samples()[k], posteriors.data());
      evidence.add(posteriors.data(), logits.turns());
    }
    const Eigen::VectorXf features = evidence.features();
    all[i] = {{features.data(), features.data() + features.size()}, person.heading};
  });
  return all;
}

}  // namespace vesalius
