#pragma once

// The messages of learning all leaves of a forest together. learn_leaves.h explains their order. Replies are integers
// and merge in any order to the same numbers, as those of training_messages.h.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "train/messages/training_messages.h"
#include "train/messages/training_sample.h"
#include "vesalius/forest/leaf_logits.h"

namespace vesalius {

/// Reply: the samples of each class, and of each heading among those of parts.
struct LabelCounts {
  std::vector<std::int64_t> classes;   ///< [class]
  std::vector<std::int64_t> headings;  ///< [heading]

  static void visit_fields(auto&& visit, auto&... of) { visit("classes", of.classes...)("headings", of.headings...); }
};

/// Request: how much a sample counts, in 1/kUnit.
struct SampleWeights {
  static constexpr int kUnit = 64;
  static constexpr double kOne = double{kUnit} * kUnit;  ///< the weight of a sample that counts once
  std::vector<std::int32_t> of_class;                    ///< [class]
  std::vector<std::int32_t> of_heading;                  ///< [heading]; samples of parts without heading count kUnit

  /// Returns the weight of a sample in 1/(kUnit * kUnit).
  std::int32_t of(const TrainingSample& sample) const {
    return of_class[sample.label] * (sample.heading < of_heading.size() ? of_heading[sample.heading] : kUnit);
  }

  static void visit_fields(auto&& visit, auto&... of) {
    visit("of class", of.of_class...)("of heading", of.of_heading...);
  }
};

/// Reply: for each leaf of one tree the weights of its samples by class and by side and heading, in 1/(kUnit * kUnit).
struct LeafCounts {
  std::vector<std::int64_t> weights;  ///< [leaf][LogitLayout]

  static void visit_fields(auto&& visit, auto&... self) { visit("weights", self.weights...); }
};

/// The logits of all leaves in learning.
struct LeafLogits {
  static constexpr float kUnit = 1.F / 1024.F;  ///< of a stored number, in nats
  static constexpr std::size_t kLanes = 16;     ///< rows are padded to a multiple of so many numbers

  std::size_t stride = 0;                           ///< numbers of a leaf
  std::vector<std::vector<std::int16_t>> of_trees;  ///< [tree][leaf * stride + place in the LogitLayout]

  static void visit_fields(auto&& visit, auto&... of) { visit("stride", of.stride...)("of trees", of.of_trees...); }
};
inline std::size_t padded_size(const LogitLayout& layout) {
  return (static_cast<std::size_t>(layout.size()) + LeafLogits::kLanes - 1) / LeafLogits::kLanes * LeafLogits::kLanes;
}

/// Request: the gradient over one of the parts into which all frames are divided.
struct GradientTask {
  int portion = 0;   ///< frames whose number leaves this remainder
  int portions = 1;  ///< divided by this
  int shift = 0;     ///< gradients are counted in 2^-shift of a weight of 1
};

/// Reply: the gradient of the samples' log likelihood by every logit: their weights where it is the true one, minus
/// their weights times its share.
struct LeafGradient {
  std::vector<std::vector<std::int32_t>> of_trees;  ///< [tree][leaf * stride + place]
  double log_likelihood = 0.0;                      ///< sum over the samples, for progress only
  double weight = 0.0;                              ///< of all samples

  static void visit_fields(auto&& visit, auto&... of) {
    visit("of trees", of.of_trees...)("log likelihood", of.log_likelihood...)("weight", of.weight...);
  }
};

/// A person from whom the regression of headings is learned.
struct FacingSample {
  std::vector<float> features;  ///< FacingEvidence::features
  int heading = 0;              ///< the true one

  static void visit_fields(auto&& visit, auto&... of) { visit("features", of.features...)("heading", of.heading...); }
};

}  // namespace vesalius
