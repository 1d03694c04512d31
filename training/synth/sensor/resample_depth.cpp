#include "synth/sensor/resample_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace vesalius::synth {
namespace {

/// The place of a pixel among those of the other picture, along one side.
struct Place {
  int low, high;     ///< pixels on both sides, the same at the borders
  float high_share;  ///< weight of the latter
  int nearest() const { return high_share < 0.5F ? low : high; }
};

Place place_of(int i, int count, int other_count) {
  const float at = (float(i) + 0.5F) * float(other_count) / float(count) - 0.5F;
  const int low = int(std::floor(at));
  return {std::clamp(low, 0, other_count - 1), std::clamp(low + 1, 0, other_count - 1), at - std::floor(at)};
}

/// Returns the mean of the four readings around a place, weighted by their nearness. If holes are no readings, the
/// place has one only where the nearest pixel has.
std::uint16_t interpolated(const DepthImage& depth, const Place& u, const Place& v, bool holes_blended) {
  if (!holes_blended && depth(u.nearest(), v.nearest()) == 0) return 0;
  const std::array<std::pair<std::uint16_t, float>, 4> around = {
      std::pair{depth(u.low, v.low), (1.F - u.high_share) * (1.F - v.high_share)},
      std::pair{depth(u.high, v.low), u.high_share * (1.F - v.high_share)},
      std::pair{depth(u.low, v.high), (1.F - u.high_share) * v.high_share},
      std::pair{depth(u.high, v.high), u.high_share * v.high_share}};
  float sum = 0.F, weights = 0.F;
  for (const auto& [z, weight] : around) {
    if (z == 0 && !holes_blended) continue;
    sum += weight * float(z);
    weights += weight;
  }
  return weights > 0.F ? static_cast<std::uint16_t>(sum / weights + 0.5F) : std::uint16_t{0};
}

/// Returns the picture in another size, and in `nearest` the pixels of it that are nearest to those of the result.
DepthImage resized(const DepthImage& depth, int width, int height, bool blend, bool holes_blended,
                   Image<std::uint32_t>& nearest) {
  DepthImage result(width, height);
  nearest = Image<std::uint32_t>(width, height);
  for (int y = 0; y < height; ++y) {
    const Place v = place_of(y, height, depth.height());
    for (int x = 0; x < width; ++x) {
      const Place u = place_of(x, width, depth.width());
      result(x, y) = blend ? interpolated(depth, u, v, holes_blended) : depth(u.nearest(), v.nearest());
      nearest(x, y) = static_cast<std::uint32_t>(v.nearest() * depth.width() + u.nearest());
    }
  }
  return result;
}

int side(int pixels, float scale) { return std::max(1, int(std::lround(float(pixels) * scale))); }

}  // namespace

void visit_options(const std::string& prefix, ResamplingOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "share", o.share,
                 {"", 0, 1, "Share of frames that had another size once, as many recordings and datasets had."});
  visitor.option(prefix + "smallest", o.smallest, {"", 0.1, 1, "Smallest size they had, as a share of theirs."});
  visitor.option(prefix + "holes-blended", o.holes_blended,
                 {"", 0, 1, "Share of those in which holes were blended with readings as if their depth were 0."});
}

Resampling draw_resampling(const ResamplingOptions& options, Random& random) {
  const bool changed = random.uniform() < options.share;
  Resampling drawn;
  drawn.scale = float(random.uniform(options.smallest, 1.0));
  const std::uint32_t ways = 1 + random.below(3);
  drawn.interpolated_down = (ways & 1U) != 0;
  drawn.interpolated_up = (ways & 2U) != 0;
  drawn.holes_blended = random.uniform() < options.holes_blended;
  return changed ? drawn : Resampling{};
}

void apply(const Resampling& resampling, DepthImage& depth, Image<std::uint32_t>* source) {
  if (resampling.scale == 1.F) return;
  const int width = depth.width(), height = depth.height();
  Image<std::uint32_t> down, up;
  const DepthImage small = resized(depth, side(width, resampling.scale), side(height, resampling.scale),
                                   resampling.interpolated_down, resampling.holes_blended, down);
  depth = resized(small, width, height, resampling.interpolated_up, resampling.holes_blended, up);
  if (source == nullptr) return;
  Image<std::uint32_t> read(width, height);
  for (std::size_t i = 0; i < read.size(); ++i) read[i] = (*source)[down[up[i]]];
  *source = std::move(read);
}

}  // namespace vesalius::synth
