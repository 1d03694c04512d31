#include "train/samples/training_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "train/samples/walk_samples.h"
#include "vesalius/base/options.h"
#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// Returns the parts' share of a sample's posterior in 1/(255 trees).
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

/// Sorts by frame, and within it along bands 16 pixels high, so that consecutive samples read the same cache lines.
void sort_samples(std::vector<TrainingSample>::iterator begin, std::vector<TrainingSample>::iterator end) {
  const auto key = [](const TrainingSample& sample) { return std::tuple(sample.frame, sample.v / 16, sample.u); };
  std::stable_sort(begin, end, [&](const TrainingSample& a, const TrainingSample& b) { return key(a) < key(b); });
}

}  // namespace

TrainingSet::TrainingSet(BodyModel body, FeatureConvention convention, const SampleOptions& options, std::uint64_t seed,
                         std::size_t first_frame)
    : TrainingSet(std::move(body), options, seed, first_frame, {.frames = FrameStore(convention)}) {}

TrainingSet::TrainingSet(BodyModel body, const SampleOptions& options, std::uint64_t seed, std::size_t first_frame,
                         Contents contents)
    : body_(std::move(body)),
      options_(options),
      seed_(seed),
      first_frame_(first_frame),
      contents_(std::move(contents)) {
  RangeCheck range;
  visit_options("", options_, range);
  if (body_.parts.empty() || body_.part_count() >= kBackground) {
    throw Error(fmt::format("training: body with {} parts, expected 1 to 254", body_.part_count()));
  }
  contents_.class_pixels.resize(body_.parts.size() + 1, 0);
  for (const auto* samples : {&contents_.samples, &contents_.pool, &contents_.held_out, &contents_.people_samples}) {
    for (const TrainingSample& sample : *samples) expect_inside(sample, samples != &contents_.people_samples);
  }
  for (const PersonSamples& person : contents_.people) {
    if (person.begin > person.end || person.end > contents_.people_samples.size()) {
      throw Error("training: a person's samples are beyond the last one");
    }
  }
}

/// Throws unless a sample is a pixel of a frame and, if it is learned from, has a class.
void TrainingSet::expect_inside(const TrainingSample& sample, bool labelled) const {
  const FrameStore& frames = contents_.frames;
  if (sample.frame < frames.size() && sample.u >= 0 && sample.v >= 0 && sample.u < frames.camera(sample.frame).width &&
      sample.v < frames.camera(sample.frame).height && sample.depth_mm > 0 &&
      (!labelled || sample.label <= body_.part_count())) {
    return;
  }
  throw Error(fmt::format("training: sample ({}, {}) of class {} is in no frame", sample.u, sample.v, sample.label));
}

void TrainingSet::add(const LabelledFrame& labelled) {
  const std::size_t index = first_frame_ + contents_.frames.size();
  Random random(seed_, index);
  const std::string where = fmt::format("training frame {} ({})", index, labelled.frame.name);
  DrawnSamples drawn = draw_samples(labelled, body_, options_, random, where);
  const auto frame = static_cast<std::uint32_t>(contents_.frames.add(labelled.frame.camera, labelled.frame.depth));
  for (std::vector<TrainingSample>* samples : {&drawn.samples, &drawn.pool}) {
    for (TrainingSample& sample : *samples) sample.frame = frame;
    sort_samples(samples->begin(), samples->end());
  }
  const std::size_t period = options_.held_out_share > 0.F ? std::lround(1.F / options_.held_out_share) : 0;
  if (period > 0 && index % period == period - 1) {
    contents_.held_out.insert(contents_.held_out.end(), drawn.samples.begin(), drawn.samples.end());
    draw_people(labelled, body_, frame, contents_.people_samples, contents_.people);
    return;
  }
  contents_.samples.insert(contents_.samples.end(), drawn.samples.begin(), drawn.samples.end());
  contents_.pool.insert(contents_.pool.end(), drawn.pool.begin(), drawn.pool.end());
  for (std::size_t c = 0; c < contents_.class_pixels.size(); ++c) contents_.class_pixels[c] += drawn.class_pixels[c];
}

Forest TrainingSet::untrained_forest() const {
  Forest forest;
  forest.body = body_;
  forest.convention = convention();
  forest.has_background = has_background();
  return forest;
}

HardCounts TrainingSet::count_hard_negatives(const Forest& forest) {
  if (!has_background()) throw Error("training: hard negatives expect a background class");
  constexpr int kGrain = 4096;
  const std::uint32_t most = static_cast<std::uint32_t>(forest.trees.size()) * 255U;
  pool_shares_.assign(contents_.pool.size(), 0);
  parallel_ranges(int(contents_.pool.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const std::uint32_t share = body_share(forest, contents_.frames, contents_.pool[i]);
      if (share > most / 2U) pool_shares_[i] = share;
    }
  });
  const auto background = static_cast<std::uint8_t>(body_.part_count());
  HardCounts hard{std::ranges::count(contents_.samples, background, &TrainingSample::label),
                  std::vector<std::uint64_t>(most + 1, 0)};
  for (const std::uint32_t share : pool_shares_) hard.counts[share] += share > 0 ? 1 : 0;
  return hard;
}

std::size_t TrainingSet::add_hard_negatives(const HardCut& cut) {
  std::vector<std::size_t> hard;
  std::uint64_t ties = cut.ties;
  for (std::size_t i = 0; i < pool_shares_.size(); ++i) {
    if (pool_shares_[i] == 0 || pool_shares_[i] < cut.above) continue;
    const bool tied = pool_shares_[i] == cut.above;
    if (tied && ties == 0) continue;
    if (tied) --ties;
    hard.push_back(i);
  }
  std::ranges::stable_sort(hard, [&](std::size_t a, std::size_t b) { return pool_shares_[a] > pool_shares_[b]; });
  for (const std::size_t i : hard) contents_.samples.push_back(contents_.pool[i]);
  sort_samples(contents_.samples.begin(), contents_.samples.end());
  contents_.pool = {};
  pool_shares_ = {};
  return hard.size();
}

SampleCounts TrainingSet::sample_counts() const {
  SampleCounts counts{std::vector<std::int64_t>(class_count(), 0),
                      {contents_.class_pixels.begin(), contents_.class_pixels.begin() + class_count()}};
  for (const TrainingSample& sample : contents_.samples) ++counts.samples[sample.label];
  return counts;
}

std::size_t TrainingSet::bytes() const {
  return contents_.frames.bytes() + (contents_.samples.capacity() + contents_.pool.capacity() +
                                     contents_.held_out.capacity() + contents_.people_samples.capacity()) *
                                        sizeof(TrainingSample);
}

}  // namespace vesalius
