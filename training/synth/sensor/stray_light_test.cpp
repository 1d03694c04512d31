#include "synth/sensor/stray_light.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace vesalius::synth {
namespace {

/// Returns a dark square in front of a bright wall.
Rendering dark_square() {
  Rendering r;
  r.depth_m = Image<float>(80, 60, 3.F);
  r.infrared = Image<float>(80, 60, 0.8F);
  for (int v = 25; v < 35; ++v) {
    std::fill_n(r.depth_m.row(v) + 35, 10, 1.F);
    std::fill_n(r.infrared.row(v) + 35, 10, 0.02F);
  }
  return r;
}

TEST(StrayLight, MovesDarkSurfacesTowardsTheBrightOnesAroundThem) {
  Rendering r = dark_square();
  add_stray_light(0.05F, r);
  EXPECT_GT(r.depth_m(40, 30), 1.05F);
  EXPECT_LT(r.depth_m(40, 30), 3.F);
  EXPECT_NEAR(r.depth_m(5, 5), 3.F, 0.01F);
}

TEST(StrayLight, HardlyMovesBrightSurfacesAndLeavesEmptySpace) {
  Rendering r = dark_square();
  std::ranges::fill(r.infrared, 0.8F);
  r.depth_m(2, 2) = 0.F;
  add_stray_light(0.05F, r);
  EXPECT_NEAR(r.depth_m(40, 30), 1.F, 0.05F);
  EXPECT_EQ(r.depth_m(2, 2), 0.F);
}

TEST(StrayLight, IsNothingWithoutAShare) {
  Rendering r = dark_square();
  add_stray_light(0.F, r);
  EXPECT_EQ(r.depth_m, dark_square().depth_m);
}

}  // namespace
}  // namespace vesalius::synth
