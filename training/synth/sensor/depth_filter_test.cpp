#include "synth/sensor/depth_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>

namespace vesalius::synth {
namespace {

constexpr int kWidth = 60, kHeight = 40;
constexpr int kEdge = 30;  ///< the first column of the far side

/// Returns a near surface beside a far one.
DepthImage step(std::uint16_t near_mm, std::uint16_t far_mm) {
  DepthImage depth(kWidth, kHeight, far_mm);
  for (int v = 0; v < kHeight; ++v) std::fill_n(depth.row(v), kEdge, near_mm);
  return depth;
}

void punch(DepthImage& depth, int left, int right) {
  for (int v = 10; v < 20; ++v) std::fill(depth.row(v) + left, depth.row(v) + right, std::uint16_t{0});
}

TEST(DepthFilter, FillsHolesFromTheNeighbourThatIsAskedFor) {
  for (const auto& [fill, expected] :
       {std::pair{HoleFill::left, 1000}, {HoleFill::farthest, 3000}, {HoleFill::nearest, 1000}}) {
    DepthImage depth = step(1000, 3000);
    punch(depth, kEdge - 3, kEdge + 5);
    apply({.fill = fill}, depth);
    EXPECT_EQ(std::ranges::count(depth, 0), 0);
    EXPECT_EQ(depth(kEdge + 4, 15), expected) << static_cast<int>(fill);
    EXPECT_EQ(depth(kEdge + 5, 15), 3000);
  }
}

TEST(DepthFilter, LeavesBordersWithoutReadings) {
  DepthImage depth = step(1000, 3000);
  for (int v = 0; v < kHeight; ++v) std::fill(depth.row(v) + kWidth - 8, depth.row(v) + kWidth, std::uint16_t{0});
  for (int v = 0; v < 3; ++v) std::fill_n(depth.row(v), kWidth, std::uint16_t{0});
  for (const HoleFill fill : {HoleFill::left, HoleFill::farthest, HoleFill::nearest}) {
    DepthImage filled = depth;
    apply({.fill = fill}, filled);
    EXPECT_EQ(filled, depth);
  }
  const DepthImage nothing(kWidth, kHeight, 0);
  DepthImage filled = nothing;
  apply({.fill = HoleFill::nearest, .smoothing = 0.5F, .passes = 1, .blur_px = 4.F}, filled);
  EXPECT_EQ(filled, nothing);
}

TEST(DepthFilter, LeavesHolesAtTheLeftBorderWithoutANeighbour) {
  DepthImage depth = step(1000, 3000);
  punch(depth, 0, 4);
  apply({.fill = HoleFill::left}, depth);
  EXPECT_EQ(std::ranges::count(depth, 0), 40);
}

TEST(DepthFilter, FillsNoFartherThanItsReach) {
  DepthImage depth = step(1000, 3000);
  for (int v = 0; v < kHeight; ++v) std::fill(depth.row(v) + 10, depth.row(v) + kEdge, std::uint16_t{0});
  for (const HoleFill fill : {HoleFill::left, HoleFill::farthest, HoleFill::nearest}) {
    DepthImage filled = depth;
    apply({.fill = fill, .fill_px = 6}, filled);
    for (int v = 0; v < kHeight; ++v) {
      EXPECT_EQ(filled(15, v), 1000) << "without teeth, row " << v;
      EXPECT_EQ(filled(16, v), 0);
    }
  }
}

TEST(DepthFilter, MovesTheTruthWithFilledReadings) {
  DepthImage depth = step(1000, 3000);
  punch(depth, kEdge, kEdge + 5);
  Image<std::uint32_t> source(kWidth, kHeight);
  std::iota(source.begin(), source.end(), 0U);
  apply({.fill = HoleFill::left, .smoothing = 0.5F, .passes = 1, .blur_px = 4.F}, depth, &source);
  EXPECT_EQ(source(kEdge + 4, 15), 15U * kWidth + kEdge - 1);
  EXPECT_EQ(source(kEdge + 5, 15), 15U * kWidth + kEdge + 5) << "a blurred pixel is still its own";
}

TEST(DepthFilter, SmoothsNoiseAndKeepsEdges) {
  DepthImage depth = step(1000, 3000);
  Random random(1);
  for (std::uint16_t& z : depth) z = static_cast<std::uint16_t>(z + random.below(21) - 10);
  const auto spread = [](const DepthImage& image, int from, int to) {
    int low = 65535, high = 0;
    for (int v = 5; v < kHeight - 5; ++v) {
      const auto [least, most] = std::minmax_element(image.row(v) + from, image.row(v) + to);
      low = std::min<int>(low, *least);
      high = std::max<int>(high, *most);
    }
    return high - low;
  };
  apply({.smoothing = 0.8F, .passes = 2, .step_per_m = 0.03F}, depth);
  EXPECT_LT(spread(depth, 5, kEdge), 8);
  EXPECT_LT(spread(depth, kEdge, kWidth - 5), 8);
}

TEST(DepthFilter, SmoothsOverStepsThatAreSmallAtTheirDistance) {
  const auto at_edge = [](std::uint16_t near_mm) {
    DepthImage depth = step(near_mm, static_cast<std::uint16_t>(near_mm + 200));
    apply({.smoothing = 0.8F, .passes = 1, .step_per_m = 0.03F}, depth);
    return std::abs(depth(kEdge, 20) - depth(kEdge - 1, 20));
  };
  EXPECT_EQ(at_edge(1000), 200) << "0.167 1/m";
  EXPECT_LT(at_edge(3000), 100) << "0.021 1/m, as of a man before a sofa";
}

TEST(DepthFilter, BlursEdgesWithinItsReach) {
  const DepthImage sharp = step(1000, 3000);
  for (const int reach : {2, 4, 8}) {
    DepthImage depth = sharp;
    apply({.blur_px = static_cast<float>(reach)}, depth);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const bool within = u >= kEdge - reach && u < kEdge + reach;
        if (within) continue;
        EXPECT_EQ(depth(u, v), sharp(u, v)) << reach << " " << u;
      }
      EXPECT_GT(depth(kEdge - 1, v), 1200) << "the edge is bridged";
      EXPECT_LT(depth(kEdge, v), 2800);
    }
  }
}

TEST(DepthFilter, BlursWhatIsFarOnly) {
  DepthImage near = step(1000, 1400), far = step(4000, 5000);
  const DepthImage near_before = near;
  const DepthFilter filter{.far_blur_px = 6.F};
  apply(filter, near);
  apply(filter, far);
  EXPECT_EQ(near, near_before);
  EXPECT_GT(far(kEdge - 1, 20), 4200);
}

TEST(DepthFilter, TakesNoReadingsFromHoles) {
  DepthImage depth = step(2000, 2000);
  punch(depth, 20, 40);
  const DepthImage before = depth;
  apply({.smoothing = 0.8F, .passes = 2, .blur_px = 6.F}, depth);
  EXPECT_EQ(depth, before);
}

TEST(DepthFilter, DrawsWithinItsOptions) {
  const DepthFilterOptions options{.fill_share = 0.5F, .smoothing = 0.6F, .blur_px = 2.F, .far_blur_px = 5.F};
  int filled = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    Random random(2, i), again(2, i);
    const DepthFilter filter = draw_filter(options, random);
    filled += filter.fill.has_value() ? 1 : 0;
    EXPECT_GE(filter.smoothing, 0.3F);
    EXPECT_LE(filter.smoothing, 0.6F);
    EXPECT_GE(filter.passes, 1);
    EXPECT_LE(filter.blur_px, 2.F);
    EXPECT_LE(filter.far_blur_px, 5.F);
    EXPECT_EQ(draw_filter(options, again).blur_px, filter.blur_px);
  }
  EXPECT_NEAR(filled, 200, 50);
}

}  // namespace
}  // namespace vesalius::synth
