#include "synth/sensor/depth_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "vesalius/base/random.h"

namespace vesalius::synth {
namespace {

TEST(DepthStatistics, FindsTheNoiseAndTheStepsOfAWall) {
  Random random(1);
  DepthStatistics statistics;
  for (int frame = 0; frame < 4; ++frame) {
    DepthImage depth(200, 100);
    for (std::uint16_t& z : depth) z = static_cast<std::uint16_t>(5 * std::lround((2000 + random.normal(0, 8)) / 5));
    statistics.add(depth);
  }
  const DepthFigures figures = statistics.figures();
  EXPECT_NEAR(figures.noise_mm[1], 8.1, 0.4) << "and the rounding";
  EXPECT_EQ(figures.step_mm[1], 5.0);
  EXPECT_TRUE(std::isnan(figures.noise_mm[2])) << "nothing at 3 m";
  EXPECT_EQ(figures.holes, 0.0);
  EXPECT_EQ(figures.edge_pixels, 0.0);
}

TEST(DepthStatistics, ASlantedPlaneHasNoNoise) {
  DepthImage depth(200, 100);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u)
      depth(u, v) = static_cast<std::uint16_t>(std::lround(2000.0 / (1.0 + u * 1e-3)));
  }
  DepthStatistics statistics;
  statistics.add(depth);
  EXPECT_LT(statistics.figures().noise_mm[1], 0.5) << "rounding to millimetres only";
}

TEST(DepthStatistics, MeasuresHolesBesideSteps) {
  DepthImage depth(100, 10, 2000);
  for (int v = 0; v < 10; ++v) {
    for (int u = 0; u < 8; ++u) depth(u, v) = 0;       // border
    for (int u = 40; u < 47; ++u) depth(u, v) = 0;     // shadow
    for (int u = 47; u < 60; ++u) depth(u, v) = 1000;  // then straight back to 2 m
  }
  DepthStatistics statistics;
  statistics.add(depth);
  const DepthFigures figures = statistics.figures();
  EXPECT_DOUBLE_EQ(figures.holes, 0.15);
  EXPECT_EQ(figures.border_px, (std::array{8.0, 0.0, 0.0, 0.0}));
  EXPECT_DOUBLE_EQ(figures.holes_at_steps, 0.5);
  EXPECT_EQ(figures.hole_width_px, 7.0);
  EXPECT_DOUBLE_EQ(figures.edge_pixels, 2.0 / 85.0);
}

TEST(DepthStatistics, MeasuresRampsAndHolesOnSurfaces) {
  DepthImage depth(100, 10, 2000);
  for (int v = 0; v < 10; ++v) {
    for (int u = 20; u < 25; ++u) depth(u, v) = 0;  // on the surface
    for (int u = 60; u < 100; ++u) depth(u, v) = 3000;
    depth(60, v) = 2300;
    depth(61, v) = 2600;
    depth(19, v) = 1500;  // blended with the hole
  }
  DepthStatistics statistics;
  statistics.add(depth);
  const DepthFigures figures = statistics.figures();
  EXPECT_EQ(figures.ramp_px, 1.0) << "2, and none where the rim drops";
  EXPECT_EQ(figures.rims_drawn_in, 0.5);
  EXPECT_TRUE(std::isnan(figures.surface_holes[0]));
  EXPECT_EQ(figures.border_px, (std::array{0.0, 0.0, 0.0, 0.0}));
}

TEST(DepthStatistics, HolesOnSurfacesCountAtTheirDistance) {
  DepthImage depth(100, 10, 2000);
  for (int v = 0; v < 10; ++v) std::fill_n(depth.row(v) + 20, 11, std::uint16_t{0});
  DepthStatistics statistics;
  statistics.add(depth);
  EXPECT_NEAR(statistics.figures().surface_holes[1], 11.0 / 99.0, 1e-9);
  EXPECT_TRUE(std::isnan(statistics.figures().surface_holes[2]));
}

TEST(DepthStatistics, GathersTheSameInParts) {
  Random random(2);
  DepthStatistics all, first, second;
  for (int frame = 0; frame < 4; ++frame) {
    DepthImage depth(80, 60);
    for (std::uint16_t& z : depth) z = static_cast<std::uint16_t>(random.below(400) == 0 ? 0 : random.normal(2000, 8));
    all.add(depth);
    (frame < 2 ? first : second).add(depth);
  }
  first.add(second);
  EXPECT_EQ(first.figures().holes, all.figures().holes);
  EXPECT_EQ(first.figures().noise_mm[1], all.figures().noise_mm[1]);
  EXPECT_EQ(first.figures().surface_holes[1], all.figures().surface_holes[1]);
  EXPECT_EQ(first.figures().step_mm[1], all.figures().step_mm[1]);
}

}  // namespace
}  // namespace vesalius::synth
