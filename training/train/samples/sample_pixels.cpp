#include "train/samples/sample_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "vesalius/base/body_heading.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

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
