#include "vesalius/appearance.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "vesalius/error.h"
#include "vesalius/parallel.h"
#include "vesalius/row_kernels.h"

namespace vesalius {
namespace {

constexpr int kPixels = 4096;  // that a thread takes at once

/// Blurs `count` values from `begin` on with a box of three; neighbouring hues, 5 degrees apart, look alike.
void blur_range(std::vector<float>& values, std::size_t begin, int count, bool wraps) {
  const std::vector<float> source(values.begin() + static_cast<std::ptrdiff_t>(begin),
                                  values.begin() + static_cast<std::ptrdiff_t>(begin) + count);
  const auto value = [&](int i) {
    if (wraps) i = (i + count) % count;
    return i >= 0 && i < count ? source[i] : 0.F;
  };
  for (int i = 0; i < count; ++i) values[begin + i] = (value(i - 1) + value(i) + value(i + 1)) / 3.F;
}

void blur_hues(std::vector<float>& counts, std::size_t begin) {
  blur_range(counts, begin, HueAppearance::kHues, true);
  blur_range(counts, begin + HueAppearance::kHues, HueAppearance::kGreys, false);
}

int lightness(Rgb colour) { return std::max({colour.r, colour.g, colour.b}); }

/// Returns the sum over the pixels `kReach` to both sides along one axis of an image.
constexpr int kReach = 2;
Image<int> sums_along(const Image<int>& values, bool along_rows) {
  const int width = values.width(), height = values.height();
  const int length = along_rows ? width : height;
  Image<int> sums(width, height, 0);
  for (int line = 0; line < (along_rows ? height : width); ++line) {
    const auto at = [&](const auto& image, int i) -> auto& { return along_rows ? image(i, line) : image(line, i); };
    int sum = 0;
    for (int i = 0; i < std::min(kReach, length); ++i) sum += at(values, i);
    for (int i = 0; i < length; ++i) {
      if (i + kReach < length) sum += at(values, i + kReach);
      if (i - kReach > 0) sum -= at(values, i - kReach - 1);
      (along_rows ? sums(i, line) : sums(line, i)) = sum;
    }
  }
  return sums;
}

/// Returns for each pixel the mean step of lightness between neighbours of one surface around it.
Image<int> mean_steps(const Frame& frame) {
  constexpr int kSurfaceStep_mm = 50;
  const int width = frame.colour.width(), height = frame.colour.height();
  Image<int> steps(width, height, 0), pairs(width, height, 0);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      for (const auto& [du, dv] : {std::array{1, 0}, std::array{0, 1}}) {
        if (u + du >= width || v + dv >= height) continue;
        const int here = frame.depth(u, v), there = frame.depth(u + du, v + dv);
        if (here == 0 || there == 0 || std::abs(here - there) > kSurfaceStep_mm) continue;
        steps(u, v) += std::abs(lightness(frame.colour(u, v)) - lightness(frame.colour(u + du, v + dv)));
        ++pairs(u, v);
      }
    }
  }
  Image<int> mean = sums_along(sums_along(steps, true), false);
  pairs = sums_along(sums_along(pairs, true), false);
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] /= std::max(1, pairs[i]);
  return mean;
}

}  // namespace

int HueAppearance::class_of(Rgb colour) {
  std::uint16_t look = 0;
  classify_hues(&colour, 1, kHues, &look);
  return look;
}

std::vector<std::uint16_t> HueAppearance::describe(const Frame& frame) const {
  std::vector<std::uint16_t> looks(frame.colour.size());
  parallel_ranges(int(looks.size()), kPixels, [&](int begin, int end) {
    classify_hues(frame.colour.data() + begin, end - begin, kHues, looks.data() + begin);
  });
  return looks;
}

void HueAppearance::blur(std::vector<float>& counts) const { blur_hues(counts, 0); }

std::vector<std::uint16_t> TextureAppearance::describe(const Frame& frame) const {
  constexpr std::array<int, kLevels - 1> kLeast{6, 16};  // steps from which a surface is rough, and striped
  std::vector<std::uint16_t> looks = hue_.describe(frame);
  if (looks.empty()) return looks;
  const Image<int> steps = mean_steps(frame);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const auto level = std::ranges::count_if(kLeast, [&](int least) { return steps[i] >= least; });
    looks[i] = static_cast<std::uint16_t>(looks[i] + level * HueAppearance::kClasses);
  }
  return looks;
}

void TextureAppearance::blur(std::vector<float>& counts) const {
  for (int level = 0; level < kLevels; ++level) {
    blur_hues(counts, static_cast<std::size_t>(level) * HueAppearance::kClasses);
  }
}

std::shared_ptr<const Appearance> make_appearance(const std::string& name) {
  if (name == "hue") return std::make_shared<HueAppearance>();
  if (name == "texture") return std::make_shared<TextureAppearance>();
  if (name == "none") return nullptr;
  throw UsageError("grow.appearance: expected hue, texture or none, found '" + name + "'");
}

Looks look_at(const Frame& frame, const Appearance* appearance) {
  Looks looks{appearance, {}, {}};
  if (appearance != nullptr) looks.classes = appearance->describe(frame);
  for (const std::uint16_t look : looks.classes) looks.all.add(look);
  return looks;
}

void AppearanceHistogram::add(const AppearanceHistogram& other) {
  if (other.counts_.size() > counts_.size()) counts_.resize(other.counts_.size(), 0);
  for (std::size_t i = 0; i < other.counts_.size(); ++i) counts_[i] += other.counts_[i];
  samples_ += other.samples_;
}

void AppearanceHistogram::scale(float factor) {
  samples_ = 0;
  for (std::uint32_t& count : counts_) {
    count = static_cast<std::uint32_t>(double(count) * double(factor));
    samples_ += count;
  }
}

std::vector<float> AppearanceHistogram::probabilities(const Appearance& appearance) const {
  std::vector<float> values(counts_.begin(), counts_.end());
  values.resize(appearance.classes(), 0.F);
  appearance.blur(values);
  float total = 0.F;
  for (const float value : values) total += value;
  // A share for unseen looks keeps ratios finite.
  constexpr float kUnseen = 0.05F;
  const float least = kUnseen / float(appearance.classes());
  for (float& value : values) value = (total > 0.F ? (1.F - kUnseen) * value / total : 0.F) + least;
  return values;
}

AppearanceHistogram learn_appearance(const Frame& frame, const Mask& mask, const Appearance& appearance) {
  AppearanceHistogram histogram;
  const std::vector<std::uint16_t> looks = appearance.describe(frame);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (mask[i] != 0) histogram.add(looks[i]);
  }
  return histogram;
}

}  // namespace vesalius
