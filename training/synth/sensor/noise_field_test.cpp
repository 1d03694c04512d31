#include "synth/sensor/noise_field.h"

#include <gmock/gmock.h>

#include <cmath>

namespace vesalius::synth {
namespace {

/// Returns the mean product of values that are `du` columns and `dv` rows apart, over many fields.
double correlation(float window_px, int du, int dv) {
  double sum = 0.0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const NoiseField field(97, 83, window_px, random);
    for (int v = 0; v + dv < 83; ++v) {
      for (int u = 0; u + du < 97; ++u, ++count) sum += field.at(u, v) * field.at(u + du, v + dv);
    }
  }
  return sum / count;
}

TEST(NoiseField, HasUnitVarianceForEveryWindow) {
  for (const float window_px : {1.F, 3.5F, 7.F, 14.F})
    EXPECT_NEAR(correlation(window_px, 0, 0), 1.0, 0.04) << window_px;
}

TEST(NoiseField, IsCorrelatedWithinItsWindow) {
  for (const float window_px : {4.F, 8.F, 14.F}) {
    const int half = static_cast<int>(window_px) / 2;
    EXPECT_NEAR(correlation(window_px, half, 0), 0.5, 0.06) << window_px;
    EXPECT_NEAR(correlation(window_px, 0, half), 0.5, 0.06) << window_px;
    EXPECT_NEAR(correlation(window_px, 2 * half, 0), 0.05, 0.05) << window_px;
    EXPECT_NEAR(correlation(window_px, 0, 4 * half), 0.0, 0.04) << window_px;
  }
}

TEST(NoiseField, GivesRowsAndSingleValuesAlike) {
  Random random(3);
  NoiseField field(50, 20, 5.F, random);
  for (int v = 0; v < 20; ++v) {
    const Eigen::ArrayXf row = field.row(v);
    for (int u = 0; u < 50; ++u) ASSERT_NEAR(row[u], field.at(u, v), 1e-5F) << u << ' ' << v;
  }
}

TEST(QuickNormal, HasMeanZeroAndUnitVariance) {
  Random random(5);
  double sum = 0.0;
  double square = 0.0;
  constexpr int kDraws = 400000;
  for (int i = 0; i < kDraws; ++i) {
    const double x = quick_normal(random);
    sum += x;
    square += x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.006);
  EXPECT_NEAR(square / kDraws, 1.0, 0.01);
}

}  // namespace
}  // namespace vesalius::synth
