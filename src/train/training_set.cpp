#include "train/training_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "train/sample_pixels.h"
#include "train/walk_samples.h"
#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"
#include "vesalius/base/random.h"

namespace vesalius {
namespace {

/// How much of a sample's posterior the parts have together, in 1/(255 trees).
std::uint32_t body_share(const Forest& forest, const FrameStore& frames, const TrainingSample& sample) {
  std::uint32_t sum = 0;
  for (const Tree& tree : forest.trees) {
    const TreeLeaf& leaf = tree.leaves[leaf_of(tree, frames, sample)];
    for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
      if (leaf.label[k] < forest.body.part_count()) sum += leaf.probability[k];
    }
  }
  return sum;
}

/// By frame, within it along bands 16 pixels high: samples that follow each other read the same cache lines.
void sort_samples(std::vector<TrainingSample>::iterator begin, std::vector<TrainingSample>::iterator end) {
  const auto key = [](const TrainingSample& sample) { return std::tuple(sample.frame, sample.v / 16, sample.u); };
  std::stable_sort(begin, end, [&](const TrainingSample& a, const TrainingSample& b) { return key(a) < key(b); });
}

}  // namespace

void visit_options(const std::string& prefix, SampleOptions& options, OptionVisitor& visitor) {
  visitor.option(prefix + "pixels", options.pixels_per_frame, {"", 1, 100000, "Pixels drawn from each frame"});
  visitor.option(prefix + "background-share", options.background_share,
                 {"", 0, 1, "Share of the pixels that lie outside all people; 0 trains without background class"});
  visitor.option(prefix + "near-share", options.near_share,
                 {"", 0, 1, "Share of the background pixels that lie beside a person"});
  visitor.option(prefix + "near-distance", options.near_px, {"pixels", 1, 10000, "What counts as beside a person"});
  visitor.option(prefix + "balanced-share", options.balanced_share,
                 {"", 0, 1, "Share of the body pixels for which every part in view counts alike"});
  visitor.option(
      prefix + "hard-pool", options.hard_pool,
      {"", 0, 100000, "Background pixels of a frame searched for hard negatives; of an empty frame 4 times"});
  visitor.option(prefix + "hard-share", options.hard_share,
                 {"", 0, 10, "Most hard negatives, as a multiple of the other background pixels"});
  visitor.option(prefix + "held-out-share", options.held_out_share,
                 {"", 0, 0.5, "Share of the frames kept back to measure accuracy on"});
}

TrainingSet::TrainingSet(BodyModel body, FeatureConvention convention, const SampleOptions& options, std::uint64_t seed)
    : body_(std::move(body)), convention_(convention), options_(options), seed_(seed), frames_(convention) {
  RangeCheck range;
  visit_options("", options_, range);
  if (body_.parts.empty() || body_.part_count() >= kBackground) {
    throw Error(fmt::format("training: body with {} parts, expected 1 to 254", body_.part_count()));
  }
  class_pixels_.assign(body_.parts.size() + 1, 0);
}

void TrainingSet::add(const LabelledFrame& labelled) {
  const std::size_t index = frames_.size();
  Random random(seed_, index);
  const std::string where = fmt::format("training frame {} ({})", index, labelled.frame.name);
  DrawnSamples drawn = draw_samples(labelled, body_, options_, random, where);
  frames_.add(labelled.frame.camera, labelled.frame.depth);
  for (std::vector<TrainingSample>* samples : {&drawn.samples, &drawn.pool}) {
    for (TrainingSample& sample : *samples) sample.frame = static_cast<std::uint32_t>(index);
    sort_samples(samples->begin(), samples->end());
  }
  const int period = options_.held_out_share > 0.F ? static_cast<int>(std::lround(1.F / options_.held_out_share)) : 0;
  if (period > 0 && static_cast<int>(index % static_cast<std::size_t>(period)) == period - 1) {
    held_out_.insert(held_out_.end(), drawn.samples.begin(), drawn.samples.end());
    return;
  }
  samples_.insert(samples_.end(), drawn.samples.begin(), drawn.samples.end());
  pool_.insert(pool_.end(), drawn.pool.begin(), drawn.pool.end());
  for (std::size_t c = 0; c < class_pixels_.size(); ++c) class_pixels_[c] += drawn.class_pixels[c];
}

std::size_t TrainingSet::add_hard_negatives(const Forest& forest) {
  std::vector<std::uint32_t> shares(pool_.size());
  constexpr int kGrain = 4096;
  parallel_ranges(static_cast<int>(pool_.size()), kGrain, [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      shares[i] = body_share(forest, frames_, pool_[i]);
    }
  });
  const std::uint32_t half = static_cast<std::uint32_t>(forest.trees.size()) * 255U / 2U;
  std::vector<std::size_t> hard;
  for (std::size_t i = 0; i < pool_.size(); ++i) {
    if (shares[i] > half) hard.push_back(i);
  }
  std::ranges::stable_sort(hard, [&](std::size_t a, std::size_t b) { return shares[a] > shares[b]; });
  const auto background =
      std::ranges::count(samples_, static_cast<std::uint8_t>(body_.part_count()), &TrainingSample::label);
  const auto most =
      static_cast<std::size_t>(static_cast<double>(options_.hard_share) * static_cast<double>(background));
  if (hard.size() > most) hard.resize(most);
  for (const std::size_t i : hard) samples_.push_back(pool_[i]);
  sort_samples(samples_.begin(), samples_.end());
  pool_ = {};
  return hard.size();
}

std::size_t TrainingSet::bytes() const {
  return frames_.bytes() + (samples_.capacity() + pool_.capacity() + held_out_.capacity()) * sizeof(TrainingSample);
}

}  // namespace vesalius
