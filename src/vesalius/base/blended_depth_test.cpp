#include "vesalius/base/blended_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace vesalius {
namespace {

constexpr int kWidth = 40, kHeight = 30;

DepthImage surface(int z_mm) { return {kWidth, kHeight, static_cast<std::uint16_t>(z_mm)}; }

/// Returns the picture resized by 2:1 as image programs do: means of 2x2 pixels, holes among them.
DepthImage halved(const DepthImage& depth) {
  DepthImage out(depth.width() / 2, depth.height() / 2, 0);
  for (int v = 0; v < out.height(); ++v) {
    for (int u = 0; u < out.width(); ++u) {
      out(u, v) = static_cast<std::uint16_t>(
          (depth(2 * u, 2 * v) + depth(2 * u + 1, 2 * v) + depth(2 * u, 2 * v + 1) + depth(2 * u + 1, 2 * v + 1)) / 4);
    }
  }
  return out;
}

TEST(BlendedDepth, KeepsWhatHasNoHoles) { EXPECT_FALSE(without_blended(surface(3000), {})); }

TEST(BlendedDepth, RemovesTheRampOfResizedHoles) {
  DepthImage depth = surface(3000);
  for (int v = 9; v < 21; ++v) {
    for (int u = 11; u < 24; ++u) depth(u, v) = 0;
  }
  const DepthImage resized = halved(depth);
  ASSERT_LT(resized(5, 7), 2000) << "half of its pixels are holes";
  const auto clean = without_blended(resized, {});
  ASSERT_TRUE(clean);
  for (std::size_t i = 0; i < clean->size(); ++i) {
    EXPECT_TRUE((*clean)[i] == 0 || (*clean)[i] == 3000) << i;
    if (resized[i] == 3000) {
      EXPECT_EQ((*clean)[i], 3000) << i;
    }
  }
}

TEST(BlendedDepth, RemovesRampsOfThreePixels) {
  DepthImage depth = surface(3800);
  constexpr std::array<std::uint16_t, 4> kRamp{0, 530, 2400, 3300};
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < 4; ++u) depth(10 + u, v) = kRamp[u];
  }
  const auto clean = without_blended(depth, {});
  ASSERT_TRUE(clean);
  for (int u = 11; u < 14; ++u) EXPECT_EQ((*clean)(u, 15), 0) << u;
  EXPECT_EQ((*clean)(14, 15), 3800);
}

TEST(BlendedDepth, KeepsAPersonBesideAShadow) {
  // A person before a wall, with the shadow of a structured-light sensor beside, and noise.
  DepthImage depth = surface(3500);
  for (int v = 5; v < 25; ++v) {
    for (int u = 12; u < 24; ++u) depth(u, v) = static_cast<std::uint16_t>(2400 + (u * 7 + v * 13) % 20);
    for (int u = 24; u < 28; ++u) depth(u, v) = 0;
  }
  const auto clean = without_blended(depth, {});
  // Corners have the hole on one side and the wall on the other.
  if (clean) {
    EXPECT_LE(std::ranges::count(*clean, 0) - std::ranges::count(depth, 0), 2);
  }
}

TEST(BlendedDepth, KeepsTheFloorSeenAtASlant) {
  DepthImage depth = surface(0);
  for (int v = 10; v < kHeight; ++v) {
    for (int u = 3; u < kWidth; ++u) {
      depth(u, v) = static_cast<std::uint16_t>(1000.0 / std::tan(0.15 + 0.004 * (v - 10)));
    }
  }
  const auto clean = without_blended(depth, {});
  long lost = 0;
  if (clean) lost = std::ranges::count(*clean, 0) - std::ranges::count(depth, 0);
  EXPECT_EQ(lost, 0);
}

TEST(BlendedDepth, DropsNothingWhenOff) {
  EXPECT_FALSE(without_blended(halved(DepthImage(4, 4, 900)), {0.F}));
  DepthImage depth = surface(3000);
  depth(4, 4) = 0;
  depth(5, 4) = 900;
  EXPECT_TRUE(without_blended(depth, {}));
  EXPECT_FALSE(without_blended(depth, {0.F}));
}

}  // namespace
}  // namespace vesalius
