#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "train/messages/training_messages.h"
#include "train/samples/training_set.h"
#include "vesalius/forest.h"

namespace vesalius {

/// Returns how many samples of each class, and of each heading among those of parts.
LabelCounts count_labels(std::span<const TrainingSample> samples, const LogitLayout& layout);

/// One shard's part in learning the leaves of a forest: which leaves its samples reach. It answers the requests of
/// LeafExecutor (training_protocol.h) for its own samples, under the same names.
class LeafShard {
 public:
  /// Walks all samples down all trees, or those of one gradient: then `leaf_counts` and other gradients make no sense.
  /// `set` must outlive this object and not change.
  LeafShard(const TrainingSet& set, const Forest& forest, LogitLayout layout, const GradientTask& portion = {});

  LabelCounts label_counts() const { return count_labels(samples_, layout_); }
  void set_weights(const SampleWeights& weights) { weights_ = weights; }
  LeafCounts leaf_counts(int tree) const;
  LeafGradient gradient(const LeafLogits& logits, const GradientTask& task) const;

 private:
  class Gradients;

  const TrainingSet& set_;
  std::span<const TrainingSample> samples_;
  LogitLayout layout_;
  SampleWeights weights_;
  std::vector<std::size_t> leaf_counts_;            ///< [tree]
  std::vector<std::vector<std::uint32_t>> leaves_;  ///< [tree][sample]
};

/// Returns the held-out people of a set as `forest`, which has logits with headings, sees them.
std::vector<FacingSample> facing_samples(const TrainingSet& set, const Forest& forest);

}  // namespace vesalius
