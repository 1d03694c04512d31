#include "synth/sensor/projector_shadow.h"

#include <gtest/gtest.h>

namespace vesalius::synth {
namespace {

constexpr Camera kCamera{200, 3, 250.F, 250.F, 99.5F, 1.F};
constexpr float kBaseline_m = 0.08F;

TEST(ProjectorShadow, MarksTheShadowOfAStep) {
  Image<float> depth(200, 3, 2.F);
  for (int v = 0; v < 3; ++v) {
    for (int u = 100; u < 140; ++u) depth(u, v) = 1.F;
  }
  // The shadow is f b (1/1 - 1/2) = 10 pixels wide, at the left of the near part's left edge.
  const Mask right = maybe_shaded(depth, kCamera, kBaseline_m);
  for (int u = 90; u < 100; ++u) EXPECT_NE(right(u, 1), 0) << u;
  for (int u = 10; u < 86; ++u) EXPECT_EQ(right(u, 1), 0) << u;
  for (int u = 104; u < 136; ++u) EXPECT_EQ(right(u, 1), 0) << u;
  const Mask left = maybe_shaded(depth, kCamera, -kBaseline_m);
  for (int u = 140; u < 150; ++u) EXPECT_NE(left(u, 1), 0) << u;
  for (int u = 154; u < 200; ++u) EXPECT_EQ(left(u, 1), 0) << u;
}

TEST(ProjectorShadow, MarksPixelsWhoseLineLeavesThePicture) {
  const Image<float> depth(200, 3, 2.F);
  const Mask mask = maybe_shaded(depth, kCamera, kBaseline_m);
  EXPECT_NE(mask(199, 1), 0);
  EXPECT_NE(mask(180, 1), 0);  // a blocker at half a metre shifts by 30 pixels
  EXPECT_EQ(mask(150, 1), 0);
  EXPECT_EQ(mask(0, 1), 0);
}

TEST(ProjectorShadow, DoesNotMarkSlopesAndHoles) {
  Image<float> depth(200, 3);
  for (int u = 0; u < 150; ++u) depth(u, 1) = 1.F + 0.01F * static_cast<float>(u);
  const Mask mask = maybe_shaded(depth, kCamera, -kBaseline_m);
  for (int u = 60; u < 145; ++u) EXPECT_EQ(mask(u, 1), 0) << u;
  for (int u = 150; u < 200; ++u) EXPECT_EQ(mask(u, 1), 0) << u;
}

}  // namespace
}  // namespace vesalius::synth
