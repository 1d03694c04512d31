#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "train/samples/walk_samples.h"
#include "vesalius/forest.h"
#include "vesalius/forest/leaf_logits.h"

namespace vesalius {

/// What a forest with logits says of samples. Each thread needs its own.
class SampleLogits {
 public:
  /// `forest` must outlive this object.
  explicit SampleLogits(const Forest& forest)
      : forest_(forest),
        layout_(forest.body, forest.has_background, forest.headings),
        reader_(layout_, forest.logit_unit, int(forest.trees.size())),
        logits_(forest.trees.size() * reader_.padded(), 0),
        turns_(static_cast<std::size_t>(kSides) * layout_.headings) {
    for (std::size_t t = 0; t < forest.trees.size(); ++t) leaves_.push_back(logits_.data() + t * reader_.padded());
  }
  SampleLogits(const SampleLogits&) = delete;
  SampleLogits& operator=(const SampleLogits&) = delete;

  const LogitLayout& layout() const { return layout_; }

  /// Writes the posteriors of the classes as LogitReader does.
  void read(const FrameStore& frames, const TrainingSample& sample, std::uint16_t* posteriors) {
    const std::size_t size = layout_.size();
    for (std::size_t t = 0; t < leaves_.size(); ++t) {
      const Tree& tree = forest_.trees[t];
      std::copy_n(tree.logits.data() + leaf_of(tree, frames, sample) * size, size,
                  logits_.data() + t * reader_.padded());
    }
    reader_.read(leaves_.data(), posteriors, turns_.data());
  }
  /// Returns P(side, heading | body) of the last sample, as LogitReader gives it.
  const std::uint16_t* turns() const { return turns_.data(); }

 private:
  const Forest& forest_;
  LogitLayout layout_;
  LogitReader reader_;
  std::vector<std::int8_t> logits_;         ///< of the last sample's leaves
  std::vector<const std::int8_t*> leaves_;  ///< where each of them begins
  std::vector<std::uint16_t> turns_;
};

}  // namespace vesalius
