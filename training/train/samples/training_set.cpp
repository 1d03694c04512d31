#include "train/samples/training_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "train/samples/walk_samples.h"
#include "vesalius/base/body_heading.h"
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

constexpr int kEmptyFramePool = 4;  ///< factor for the background that a frame without people offers

/// Indices of the pixels of one frame that have a reading.
struct PixelPools {
  std::vector<std::vector<int>> parts;  ///< one pool for each visible part
  std::vector<int> body;                ///< pixels of all parts
  std::vector<int> background;
};

PixelPools make_pools(const LabelledFrame& labelled, int part_count, std::vector<std::uint64_t>& class_pixels,
                      const std::string& where) {
  check(labelled.frame);
  if (!labelled.labels.same_size(labelled.frame.depth)) {
    throw Error(fmt::format("{}: labels and depth differ in size", where));
  }
  PixelPools pools;
  std::vector<std::vector<int>> by_part(part_count);
  for (std::size_t i = 0; i < labelled.labels.size(); ++i) {
    if (labelled.frame.depth[i] == 0) continue;
    const std::uint8_t label = labelled.labels[i];
    if (label == kBackground) {
      pools.background.push_back(int(i));
    } else if (label < part_count) {
      by_part[label].push_back(int(i));
      pools.body.push_back(int(i));
    } else {
      throw Error(fmt::format("{}: label {} at pixel ({}, {}), the body has {} parts", where, label,
                              int(i) % labelled.labels.width(), int(i) / labelled.labels.width(), part_count));
    }
  }
  for (std::size_t part = 0; part < by_part.size(); ++part) class_pixels[part] = by_part[part].size();
  class_pixels.back() = pools.background.size();
  std::erase_if(by_part, [](const std::vector<int>& pool) { return pool.empty(); });
  pools.parts = std::move(by_part);
  return pools;
}

/// Returns the heading of every person of a frame.
std::vector<std::uint8_t> headings_of(const LabelledFrame& labelled, const BodyModel& body) {
  std::vector<std::uint8_t> headings;
  for (const std::vector<Eigen::Vector3f>& centres : labelled.parts) {
    const std::optional<float> yaw = body_yaw(centres, body);
    headings.push_back(yaw ? static_cast<std::uint8_t>(heading_of_yaw(*yaw, kHeadings)) : kNoHeading);
  }
  return headings;
}

/// Draws pixels from one frame.
class Drawer {
 public:
  Drawer(const LabelledFrame& labelled, const PixelPools& pools, const SampleOptions& options, const BodyModel& body,
         Random& random)
      : labelled_(labelled),
        pools_(pools),
        options_(options),
        part_count_(body.part_count()),
        headings_(headings_of(labelled, body)),
        random_(random) {}

  std::vector<TrainingSample> ordinary() {
    const auto background = int(std::lround(double(options_.background_share) * options_.pixels_per_frame));
    std::vector<TrainingSample> samples;
    for (int i = 0; i < options_.pixels_per_frame; ++i) {
      const bool behind = i < background;
      if (behind ? pools_.background.empty() : pools_.body.empty()) continue;
      samples.push_back(sample_at(behind ? draw_background() : draw_body()));
    }
    return samples;
  }

  std::vector<TrainingSample> pool() {
    std::vector<TrainingSample> samples;
    if (pools_.background.empty() || options_.background_share <= 0.F) return samples;
    const int count = options_.hard_pool * (pools_.body.empty() ? kEmptyFramePool : 1);
    for (int i = 0; i < count; ++i) samples.push_back(sample_at(draw(pools_.background)));
    return samples;
  }

 private:
  int draw(const std::vector<int>& from) { return from[random_.below(static_cast<std::uint32_t>(from.size()))]; }

  int draw_body() {
    if (random_.uniform() >= double(options_.balanced_share)) return draw(pools_.body);
    return draw(pools_.parts[random_.below(static_cast<std::uint32_t>(pools_.parts.size()))]);
  }

  int draw_background() {
    const bool near = random_.uniform() < double(options_.near_share) && !pools_.body.empty();
    return near ? draw_near() : draw(pools_.background);
  }

  /// Draws a background pixel beside a person, where furniture, floor and walls are taken for limbs. Draws any
  /// background pixel if none is found there.
  int draw_near() {
    constexpr int kTries = 10;
    const int width = labelled_.labels.width();
    for (int i = 0; i < kTries; ++i) {
      const int at = draw(pools_.body);
      const int u = at % width + int(std::lround(random_.uniform(-options_.near_px, options_.near_px)));
      const int v = at / width + int(std::lround(random_.uniform(-options_.near_px, options_.near_px)));
      if (labelled_.labels.contains(u, v) && labelled_.labels(u, v) == kBackground &&
          labelled_.frame.depth(u, v) != 0) {
        return v * width + u;
      }
    }
    return draw(pools_.background);
  }

  TrainingSample sample_at(int index) const {
    const int width = labelled_.labels.width();
    TrainingSample sample;
    sample.u = static_cast<std::int16_t>(index % width);
    sample.v = static_cast<std::int16_t>(index / width);
    sample.depth_mm = labelled_.frame.depth(sample.u, sample.v);
    const std::uint8_t label = labelled_.labels(sample.u, sample.v);
    sample.label = label == kBackground ? static_cast<std::uint8_t>(part_count_) : label;
    if (label != kBackground && labelled_.person.contains(sample.u, sample.v)) {
      const std::uint8_t person = labelled_.person(sample.u, sample.v);
      if (person < headings_.size()) sample.heading = headings_[person];
    }
    return sample;
  }

  const LabelledFrame& labelled_;
  const PixelPools& pools_;
  const SampleOptions& options_;
  int part_count_;
  std::vector<std::uint8_t> headings_;  ///< [person]
  Random& random_;
};

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

DrawnSamples draw_samples(const LabelledFrame& labelled, const BodyModel& body, const SampleOptions& options,
                          Random& random, const std::string& where) {
  DrawnSamples drawn;
  drawn.class_pixels.assign(body.parts.size() + 1, 0);
  const PixelPools pools = make_pools(labelled, body.part_count(), drawn.class_pixels, where);
  Drawer drawer(labelled, pools, options, body, random);
  drawn.samples = drawer.ordinary();
  drawn.pool = drawer.pool();
  return drawn;
}

void draw_people(const LabelledFrame& labelled, const BodyModel& body, std::uint32_t frame,
                 std::vector<TrainingSample>& samples, std::vector<PersonSamples>& people) {
  constexpr std::size_t kMost = 400, kFewest = 100;
  const std::vector<std::uint8_t> headings = headings_of(labelled, body);
  std::vector<std::vector<TrainingSample>> of_person(headings.size());
  for (int v = 0; v < labelled.person.height(); ++v) {
    for (int u = 0; u < labelled.person.width(); ++u) {
      const std::uint8_t who = labelled.person(u, v);
      if (who >= headings.size() || headings[who] == kNoHeading || labelled.frame.depth(u, v) == 0) continue;
      of_person[who].push_back({frame, static_cast<std::int16_t>(u), static_cast<std::int16_t>(v),
                                labelled.frame.depth(u, v), labelled.labels(u, v), headings[who]});
    }
  }
  for (std::size_t who = 0; who < of_person.size(); ++who) {
    const std::vector<TrainingSample>& all = of_person[who];
    if (all.size() < kFewest) continue;
    const std::size_t count = std::min(all.size(), kMost);
    const auto begin = static_cast<std::uint32_t>(samples.size());
    for (std::size_t i = 0; i < count; ++i) samples.push_back(all[i * all.size() / count]);
    people.push_back({headings[who], begin, static_cast<std::uint32_t>(samples.size())});
  }
}

}  // namespace vesalius
