#include "train/sample_pixels.h"

#include <cmath>
#include <string>

#include "vesalius/error.h"
#include "vesalius/random.h"

namespace vesalius {
namespace {

/// Indices of the pixels of one frame that have a reading.
struct PixelPools {
  std::vector<std::vector<int>> parts;  ///< one pool for each part in view
  std::vector<int> body;                ///< all of them
  std::vector<int> background;
};

void check_frame(const LabelledFrame& labelled, std::size_t index) {
  check(labelled.frame);
  const std::string where = "training frame " + std::to_string(index) + " (" + labelled.frame.name + ")";
  if (!labelled.labels.same_size(labelled.frame.depth)) throw Error(where + ": labels and depth differ in size");
  constexpr int kLargest = 32767;
  if (labelled.labels.width() > kLargest || labelled.labels.height() > kLargest) {
    throw Error(where + ": at most " + std::to_string(kLargest) + " pixels a side");
  }
}

PixelPools make_pools(const LabelledFrame& labelled, const BodyModel& body, std::size_t index) {
  check_frame(labelled, index);
  PixelPools pools;
  std::vector<std::vector<int>> by_part(body.parts.size());
  for (std::size_t i = 0; i < labelled.labels.size(); ++i) {
    if (labelled.frame.depth[i] == 0) continue;
    const std::uint8_t label = labelled.labels[i];
    if (label == kBackground) {
      pools.background.push_back(static_cast<int>(i));
    } else if (label < by_part.size()) {
      by_part[label].push_back(static_cast<int>(i));
      pools.body.push_back(static_cast<int>(i));
    } else {
      throw Error("training frame " + std::to_string(index) + ": label " + std::to_string(label) + " at pixel " +
                  std::to_string(i) + ", the body has " + std::to_string(by_part.size()) + " parts");
    }
  }
  for (std::vector<int>& pool : by_part) {
    if (!pool.empty()) pools.parts.push_back(std::move(pool));
  }
  return pools;
}

int draw(const std::vector<int>& pool, Random& random) {
  return pool[random.below(static_cast<std::uint32_t>(pool.size()))];
}

int draw_body(const PixelPools& pools, float balanced_share, Random& random) {
  if (random.uniform() >= balanced_share) return draw(pools.body, random);
  return draw(pools.parts[random.below(static_cast<std::uint32_t>(pools.parts.size()))], random);
}

/// A background pixel beside a person: where furniture, floor and walls are taken for limbs. Any where none is met.
int draw_near(const LabelledFrame& labelled, const PixelPools& pools, int near_px, Random& random) {
  constexpr int kTries = 10;
  const int width = labelled.labels.width();
  for (int i = 0; i < kTries; ++i) {
    const int at = draw(pools.body, random);
    const int u = at % width + static_cast<int>(std::lround(random.uniform(-near_px, near_px)));
    const int v = at / width + static_cast<int>(std::lround(random.uniform(-near_px, near_px)));
    if (labelled.labels.contains(u, v) && labelled.labels(u, v) == kBackground && labelled.frame.depth(u, v) != 0) {
      return v * width + u;
    }
  }
  return draw(pools.background, random);
}

int draw_background(const LabelledFrame& labelled, const PixelPools& pools, const SampleOptions& options,
                    Random& random) {
  const bool near = random.uniform() < options.near_share && !pools.body.empty();
  return near ? draw_near(labelled, pools, options.near_px, random) : draw(pools.background, random);
}

}  // namespace

std::vector<TrainingPixel> sample_pixels(const std::vector<LabelledFrame>& frames, const BodyModel& body,
                                         const FeatureConvention& convention, const SampleOptions& options,
                                         std::uint64_t seed, std::uint64_t tree) {
  const int background =
      static_cast<int>(std::lround(static_cast<double>(options.background_share) * options.pixels_per_frame));
  std::vector<TrainingPixel> pixels;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const LabelledFrame& labelled = frames[f];
    const PixelPools pools = make_pools(labelled, body, f);
    const OffsetScaler scaler(convention, labelled.frame.camera);
    Random random(seed, (tree << 32U) | f);
    for (int i = 0; i < options.pixels_per_frame; ++i) {
      const bool behind = i < background;
      if (behind ? pools.background.empty() : pools.body.empty()) continue;
      const int at =
          behind ? draw_background(labelled, pools, options, random) : draw_body(pools, options.balanced_share, random);
      TrainingPixel pixel;
      pixel.frame = static_cast<std::int32_t>(f);
      pixel.u = static_cast<std::int16_t>(at % labelled.labels.width());
      pixel.v = static_cast<std::int16_t>(at / labelled.labels.width());
      pixel.scale = scaler.at(labelled.frame.depth(pixel.u, pixel.v));
      pixel.label = behind ? static_cast<std::uint8_t>(body.part_count()) : labelled.labels(pixel.u, pixel.v);
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

}  // namespace vesalius
