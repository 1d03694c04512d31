#include "synth/sensor/resample_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace vesalius::synth {
namespace {

constexpr int kWidth = 64, kHeight = 48, kEdge = 33;
constexpr std::uint16_t kNear = 1000, kFar = 3000;

DepthImage step() {
  DepthImage depth(kWidth, kHeight, kFar);
  for (int v = 0; v < kHeight; ++v) std::fill_n(depth.row(v), kEdge, kNear);
  return depth;
}

/// Returns how many readings of a row are neither near nor far.
std::ptrdiff_t mixed_in_row(const DepthImage& depth, int v) {
  return std::count_if(depth.row(v), depth.row(v) + kWidth, [](auto z) { return z != 0 && z != kNear && z != kFar; });
}

TEST(ResampleDepth, LeavesPicturesOfTheirOwnSize) {
  DepthImage depth = step();
  apply(Resampling{.interpolated_down = true, .interpolated_up = true, .holes_blended = true}, depth);
  EXPECT_EQ(depth, step());
}

TEST(ResampleDepth, MakesRampsOfEdgesAsWideAsThePictureWasCoarse) {
  DepthImage half = step(), quarter = step(), nearest = step();
  apply({.scale = 0.5F, .interpolated_up = true}, half);
  apply({.scale = 0.25F, .interpolated_up = true}, quarter);
  apply({.scale = 0.5F}, nearest);
  EXPECT_EQ(mixed_in_row(half, 20), 2);
  EXPECT_EQ(mixed_in_row(quarter, 20), 4);
  EXPECT_EQ(mixed_in_row(nearest, 20), 0);
  EXPECT_TRUE(std::is_sorted(half.row(20), half.row(20) + kWidth));
}

TEST(ResampleDepth, KeepsHolesOrBlendsThem) {
  DepthImage hole(kWidth, kHeight, kFar);
  for (int v = 10; v < 30; ++v) std::fill_n(hole.row(v) + 20, 12, std::uint16_t{0});
  DepthImage kept = hole, blended = hole;
  apply({.scale = 0.5F, .interpolated_up = true}, kept);
  apply({.scale = 0.5F, .interpolated_up = true, .holes_blended = true}, blended);
  EXPECT_EQ(std::ranges::count(kept, 0), std::ranges::count(hole, 0));
  EXPECT_EQ(mixed_in_row(kept, 20), 0);
  EXPECT_GT(mixed_in_row(blended, 20), 0);
  EXPECT_TRUE(std::all_of(blended.begin(), blended.end(), [](auto z) { return z <= kFar; }));
}

TEST(ResampleDepth, LabelsGoWithTheNearestReading) {
  DepthImage depth = step();
  Image<std::uint32_t> source(kWidth, kHeight);
  std::iota(source.begin(), source.end(), 0U);
  const DepthImage before = depth;
  apply({.scale = 0.4F}, depth, &source);
  for (std::size_t i = 0; i < depth.size(); ++i) ASSERT_EQ(depth[i], before[source[i]]) << i;
}

TEST(ResampleDepth, DrawsItsShareOfFramesAndSizesInTheirRange) {
  Random random(3, 1);
  int changed = 0;
  for (int i = 0; i < 1000; ++i) {
    const Resampling drawn = draw_resampling({.share = 0.3F, .smallest = 0.4F}, random);
    if (drawn.scale == 1.F) continue;
    ++changed;
    EXPECT_GE(drawn.scale, 0.4F);
    EXPECT_TRUE(drawn.interpolated_down || drawn.interpolated_up);
  }
  EXPECT_NEAR(changed, 300, 50);
}

}  // namespace
}  // namespace vesalius::synth
