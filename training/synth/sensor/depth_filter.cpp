#include "synth/sensor/depth_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace vesalius::synth {
namespace {

constexpr float kPerMetre = 1000.F;  // mm

/// Returns whether a neighbour's depth fills a hole rather than the best one so far (0 if there is none).
bool fills(HoleFill fill, std::uint16_t candidate, std::uint16_t best) {
  if (candidate == 0) return false;
  return best == 0 || (fill == HoleFill::nearest ? candidate < best : candidate > best);
}

/// Returns the distance of each pixel from the nearest reading, along columns and rows, up to 65535.
Image<std::uint16_t> distances_from_readings(const DepthImage& depth) {
  constexpr int kFar = 65535;
  const int width = depth.width(), height = depth.height();
  Image<std::uint16_t> distance(width, height, kFar);
  const auto pass = [&](int u, int v, int step) {
    if (depth(u, v) != 0) {
      distance(u, v) = 0;
      return;
    }
    int least = distance(u, v);
    for (const auto& [from_u, from_v] : {std::pair{u - step, v}, std::pair{u, v - step}}) {
      if (distance.contains(from_u, from_v)) least = std::min(least, distance(from_u, from_v) + 1);
    }
    distance(u, v) = static_cast<std::uint16_t>(least);
  };
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) pass(u, v, 1);
  }
  for (int v = height - 1; v >= 0; --v) {
    for (int u = width - 1; u >= 0; --u) pass(u, v, -1);
  }
  return distance;
}

/// Returns the smallest rectangle with all readings as [low, high] of columns and rows; it is empty without readings.
Eigen::AlignedBox2i extent_of_readings(const DepthImage& depth) {
  Eigen::AlignedBox2i extent;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) != 0) extent.extend(Eigen::Vector2i(u, v));
    }
  }
  return extent;
}

void fill_holes(HoleFill fill, int reach_px, DepthImage& depth, Image<std::uint32_t>* source) {
  using Step = std::array<int, 2>;
  constexpr std::array<Step, 5> kAround = {Step{-1, 0}, Step{-1, -1}, Step{0, -1}, Step{-1, 1}, Step{0, 1}};
  const std::size_t count = fill == HoleFill::left ? 1 : kAround.size();
  const Image<std::uint16_t> distance = distances_from_readings(depth);
  const Eigen::AlignedBox2i extent = extent_of_readings(depth);
  for (int v = extent.min().y(); v <= extent.max().y(); ++v) {
    for (int u = extent.min().x(); u <= extent.max().x(); ++u) {
      if (depth(u, v) != 0 || distance(u, v) > reach_px) continue;
      for (std::size_t k = 0; k < count; ++k) {
        const int from_u = u + kAround[k][0], from_v = v + kAround[k][1];
        if (!depth.contains(from_u, from_v) || !fills(fill, depth(from_u, from_v), depth(u, v))) continue;
        depth(u, v) = depth(from_u, from_v);
        if (source != nullptr) (*source)(u, v) = (*source)(from_u, from_v);
      }
    }
  }
}

/// Draws a pixel towards its neighbour unless there is an edge or a hole between them.
void draw_towards(float neighbour, float weight, float step, float& pixel) {
  const float difference = neighbour - pixel;
  if (neighbour > 0.F && pixel > 0.F && std::abs(difference) < step) pixel += weight * difference;
}

/// Smooths the inverse depth, of which errors of stereo are independent, by a recursive filter.
void smooth(const DepthFilter& filter, DepthImage& depth) {
  Image<float> inverse(depth.width(), depth.height());
  std::transform(depth.begin(), depth.end(), inverse.begin(),
                 [](std::uint16_t z) { return z == 0 ? 0.F : kPerMetre / float(z); });
  const int width = depth.width(), height = depth.height();
  const auto towards = [&](float neighbour, float& pixel) {
    draw_towards(neighbour, filter.smoothing, filter.step_per_m, pixel);
  };
  for (int pass = 0; pass < filter.passes; ++pass) {
    for (int v = 0; v < height; ++v) {
      float* row = inverse.row(v);
      for (int u = 1; u < width; ++u) towards(row[u - 1], row[u]);
      for (int u = width - 2; u >= 0; --u) towards(row[u + 1], row[u]);
    }
    for (int v = 1; v < height; ++v) {
      for (int u = 0; u < width; ++u) towards(inverse(u, v - 1), inverse(u, v));
    }
    for (int v = height - 2; v >= 0; --v) {
      for (int u = 0; u < width; ++u) towards(inverse(u, v + 1), inverse(u, v));
    }
  }
  std::transform(inverse.begin(), inverse.end(), depth.begin(), [](float d) {
    return d == 0.F ? std::uint16_t{0} : static_cast<std::uint16_t>(std::min(65535.F, kPerMetre / d + 0.5F));
  });
}

/// Sums of readings and their number over all rectangles from the upper left corner. Sums wrap around, which their
/// differences undo: a window's sum fits.
class Sums {
 public:
  explicit Sums(const DepthImage& depth)
      : width_(depth.width()),
        height_(depth.height()),
        depth_(static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_ + 1)),
        count_(depth_.size()) {
    for (int v = 0; v < height_; ++v) {
      std::uint32_t sum = 0, count = 0;
      for (int u = 0; u < width_; ++u) {
        sum += depth(u, v);
        count += depth(u, v) != 0 ? 1 : 0;
        depth_[at(u + 1, v + 1)] = depth_[at(u + 1, v)] + sum;
        count_[at(u + 1, v + 1)] = count_[at(u + 1, v)] + count;
      }
    }
  }

  /// Returns the rounded mean of the readings within `reach` columns and rows of a pixel that has one.
  std::uint16_t mean(int u, int v, int reach) const {
    const int left = std::max(0, u - reach), right = std::min(width_, u + reach + 1);
    const int top = std::max(0, v - reach), bottom = std::min(height_, v + reach + 1);
    const auto over = [&](const std::vector<std::uint32_t>& sums) {
      return sums[at(right, bottom)] - sums[at(left, bottom)] - sums[at(right, top)] + sums[at(left, top)];
    };
    const std::uint32_t count = over(count_);
    return static_cast<std::uint16_t>((over(depth_) + count / 2) / count);
  }

 private:
  std::size_t at(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_ + 1) + static_cast<std::size_t>(u);
  }

  int width_, height_;
  std::vector<std::uint32_t> depth_, count_;
};

/// Blurs twice with half the reach, which rounds the corners of the window.
void blur(const DepthFilter& filter, DepthImage& depth) {
  constexpr float kFrom_m = 1.5F, kTo_m = 5.F;
  constexpr int kTimes = 2;
  for (int time = 0; time < kTimes; ++time) {
    const Sums sums(depth);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        if (depth(u, v) == 0) continue;
        const float z_m = float(depth(u, v)) / kPerMetre;
        const float far = std::clamp((z_m - kFrom_m) / (kTo_m - kFrom_m), 0.F, 1.F);
        const float reach_px = filter.blur_px + far * filter.far_blur_px;
        depth(u, v) = sums.mean(u, v, int(reach_px / kTimes));
      }
    }
  }
}

}  // namespace

void visit_options(const std::string& prefix, DepthFilterOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "share", o.share,
                 {"", 0, 1, "Share of frames whose depth is filtered after it is measured, as drivers do."});
  visitor.option(prefix + "fill-share", o.fill_share, {"", 0, 1, "Share of those whose holes are filled."});
  visitor.option(prefix + "fill-reach", o.fill_px,
                 {"pixels", 0, 8192, "How far from a reading holes are filled; labels go with it."});
  visitor.option(prefix + "smoothing", o.smoothing,
                 {"", 0, 0.98, "Greatest weight of the neighbour in smoothing that keeps edges."});
  visitor.option(prefix + "step", o.step_per_m, {"1/m", 0, 1, "Steps of the inverse depth from here on are edges."});
  visitor.option(prefix + "blur", o.blur_px, {"pixels", 0, 50, "Greatest reach of the blur that bridges edges."});
  visitor.option(prefix + "far-blur", o.far_blur_px,
                 {"pixels", 0, 50, "Greatest reach of a blur that grows with depth: none at 1.5 m, this at 5 m."});
}

DepthFilter draw_filter(const DepthFilterOptions& options, Random& random) {
  constexpr std::uint32_t kMostPasses = 3;
  DepthFilter filter;
  const bool fill = random.uniform() < options.fill_share;
  const auto from = static_cast<HoleFill>(random.below(3));
  if (fill) filter.fill = from;
  filter.fill_px = options.fill_px;
  filter.smoothing = options.smoothing * float(random.uniform(0.5, 1.0));
  filter.passes = 1 + int(random.below(kMostPasses));
  filter.step_per_m = options.step_per_m;
  filter.blur_px = options.blur_px * float(random.uniform());
  filter.far_blur_px = options.far_blur_px * float(random.uniform());
  return filter;
}

void apply(const DepthFilter& filter, DepthImage& depth, Image<std::uint32_t>* source) {
  if (filter.fill) fill_holes(*filter.fill, filter.fill_px, depth, source);
  if (filter.smoothing > 0.F && filter.passes > 0) smooth(filter, depth);
  if (filter.blur_px > 0.F || filter.far_blur_px > 0.F) blur(filter, depth);
}

}  // namespace vesalius::synth
