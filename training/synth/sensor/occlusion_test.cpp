#include "synth/sensor/occlusion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "vesalius/base/random.h"

namespace vesalius::synth {
namespace {

constexpr float kNear_m = 1.F;
constexpr float kFar_m = 2.5F;
const Camera kCamera{160, 4, 525.F, 525.F, 79.5F, 1.5F};

/// Returns a wall with a board in front of it, from column 60 to 99.
Image<float> board() {
  Image<float> depth(kCamera.width, kCamera.height, kFar_m);
  for (int v = 0; v < depth.height(); ++v) std::fill(depth.row(v) + 60, depth.row(v) + 100, kNear_m);
  return depth;
}

int width_of(const Mask& mask, int begin, int end) {
  int width = 0;
  for (int u = begin; u < end; ++u) width += mask(u, 1) != 0 ? 1 : 0;
  return width;
}

TEST(HiddenFromEye, IsAsWideAsTheDifferenceOfDisparities) {
  constexpr float kEye_m = 0.025F;
  const float expected_px = kCamera.fx * kEye_m * (1.F / kNear_m - 1.F / kFar_m);  // 7.9
  const Mask right = hidden_from_eye(board(), kCamera, kEye_m);
  EXPECT_NEAR(width_of(right, 0, 60), expected_px, 1.F);
  EXPECT_EQ(width_of(right, 60, 160), 0);
  EXPECT_NE(right(59, 1), 0);
  const Mask left = hidden_from_eye(board(), kCamera, -kEye_m);
  EXPECT_NEAR(width_of(left, 100, 160), expected_px, 1.F);
  EXPECT_EQ(width_of(left, 0, 100), 0);
  EXPECT_NE(left(100, 1), 0);
}

TEST(HiddenFromEye, HidesNothingOfASlantedPlane) {
  for (const float slope : {-0.8F, 0.8F}) {
    Image<float> depth(kCamera.width, kCamera.height);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        depth(u, v) = 2.F / (1.F - slope * (static_cast<float>(u) - kCamera.cx) / kCamera.fx);
      }
    }
    EXPECT_EQ(width_of(hidden_from_eye(depth, kCamera, 0.05F), 0, 160), 0) << slope;
    EXPECT_EQ(width_of(hidden_from_eye(depth, kCamera, -0.05F), 0, 160), 0) << slope;
  }
}

TEST(HiddenFromEye, SkipsPixelsWithoutSurface) {
  const Image<float> nothing(kCamera.width, kCamera.height, 0.F);
  EXPECT_EQ(width_of(hidden_from_eye(nothing, kCamera, 0.05F), 0, 160), 0);
}

TEST(NearJumps, AgreesWithBruteForce) {
  Random random(11);
  Image<float> depth(40, 30);
  for (float& z : depth) z = random.below(60) == 0 ? 0.F : random.below(40) == 0 ? 1.5F : 2.F;
  constexpr int kRadius = 2;
  const auto jumps = [&](int u, int v, int du, int dv) {
    if (!depth.contains(u + du, v + dv)) return false;
    return std::abs(depth(u, v) - depth(u + du, v + dv)) > 0.1F;
  };
  Mask expected(40, 30, 0);
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) {
      if (!jumps(u, v, 1, 0) && !jumps(u, v, 0, 1)) continue;
      for (int y = -kRadius; y <= kRadius; ++y) {
        for (int x = -kRadius; x <= kRadius; ++x) {
          if (expected.contains(u + x, v + y)) expected(u + x, v + y) = 1;
        }
      }
    }
  }
  EXPECT_EQ(near_jumps(depth, 0.1F, kRadius), expected);
}

/// Returns random patches of three levels and holes.
Image<float> patches(int width, int height, std::uint64_t seed) {
  Random random(seed);
  Image<float> depth(width, height, kFar_m);
  for (float& z : depth) {
    if (random.below(20) == 0) z = random.below(2) == 0 ? 0.F : kNear_m;
  }
  return depth;
}

TEST(NearestWithin, IsTheSmallestDepthOfASquare) {
  for (const auto& [width, height] : {std::pair(40, 30), {3, 2}, {1, 9}}) {
    const Image<float> depth = patches(width, height, 5);
    for (const int radius : {0, 1, 3}) {
      const Image<float> nearest = nearest_within(depth, radius);
      for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
          float expected = std::numeric_limits<float>::infinity();
          for (int y = v - radius; y <= v + radius; ++y) {
            for (int x = u - radius; x <= u + radius; ++x) {
              if (depth.contains(x, y) && depth(x, y) > 0.F) expected = std::min(expected, depth(x, y));
            }
          }
          ASSERT_EQ(nearest(u, v), expected) << u << ' ' << v << " radius " << radius;
        }
      }
    }
  }
}

TEST(NearJumps, MarksTheSquaresAroundJumps) {
  const Image<float> depth = patches(40, 30, 6);
  const auto jumps = [&](int u, int v, int x, int y) {
    if (!depth.contains(u, v) || !depth.contains(x, y)) return false;
    return std::abs(depth(u, v) - depth(x, y)) > 0.1F || (depth(u, v) == 0.F) != (depth(x, y) == 0.F);
  };
  for (const int radius : {0, 2}) {
    const Mask near = near_jumps(depth, 0.1F, radius);
    for (int v = 0; v < 30; ++v) {
      for (int u = 0; u < 40; ++u) {
        bool expected = false;
        for (int y = v - radius; y <= v + radius; ++y) {
          for (int x = u - radius; x <= u + radius; ++x) {
            expected = expected || jumps(x, y, x + 1, y) || jumps(x, y, x, y + 1);
          }
        }
        ASSERT_EQ(near(u, v) != 0, expected) << u << ' ' << v << " radius " << radius;
      }
    }
  }
}

constexpr Camera kProjected{200, 3, 250.F, 250.F, 99.5F, 1.F};
constexpr float kBaseline_m = 0.08F;

TEST(ProjectorShadow, MarksTheShadowOfAStep) {
  Image<float> depth(200, 3, 2.F);
  for (int v = 0; v < 3; ++v) {
    for (int u = 100; u < 140; ++u) depth(u, v) = 1.F;
  }
  // The shadow is f b (1/1 - 1/2) = 10 pixels wide, at the left of the near part's left edge.
  const Mask right = maybe_shaded(depth, kProjected, kBaseline_m);
  for (int u = 90; u < 100; ++u) EXPECT_NE(right(u, 1), 0) << u;
  for (int u = 10; u < 86; ++u) EXPECT_EQ(right(u, 1), 0) << u;
  for (int u = 104; u < 136; ++u) EXPECT_EQ(right(u, 1), 0) << u;
  const Mask left = maybe_shaded(depth, kProjected, -kBaseline_m);
  for (int u = 140; u < 150; ++u) EXPECT_NE(left(u, 1), 0) << u;
  for (int u = 154; u < 200; ++u) EXPECT_EQ(left(u, 1), 0) << u;
}

TEST(ProjectorShadow, MarksPixelsWhoseLineLeavesThePicture) {
  const Image<float> depth(200, 3, 2.F);
  const Mask mask = maybe_shaded(depth, kProjected, kBaseline_m);
  EXPECT_NE(mask(199, 1), 0);
  EXPECT_NE(mask(180, 1), 0);  // a blocker at half a metre shifts by 30 pixels
  EXPECT_EQ(mask(150, 1), 0);
  EXPECT_EQ(mask(0, 1), 0);
}

TEST(ProjectorShadow, DoesNotMarkSlopesAndHoles) {
  Image<float> depth(200, 3);
  for (int u = 0; u < 150; ++u) depth(u, 1) = 1.F + 0.01F * static_cast<float>(u);
  const Mask mask = maybe_shaded(depth, kProjected, -kBaseline_m);
  for (int u = 60; u < 145; ++u) EXPECT_EQ(mask(u, 1), 0) << u;
  for (int u = 150; u < 200; ++u) EXPECT_EQ(mask(u, 1), 0) << u;
}

}  // namespace

}  // namespace vesalius::synth
