#include "metrics/statistics.h"

#include <gmock/gmock.h>

#include <cmath>

#include "vesalius/error.h"

namespace vesalius {
namespace {

/// The bounds solve (share - p)^2 = z^2 p (1 - p) / n. Here they are found by bisection instead of the formula.
double wilson_bound(double successes, double trials, bool low) {
  const double share = successes / trials;
  double inside = share;
  double outside = low ? 0.0 : 1.0;
  for (int i = 0; i < 200; ++i) {
    const double p = 0.5 * (inside + outside);
    const bool is_inside = (share - p) * (share - p) <= 1.959963984540054 * 1.959963984540054 * p * (1 - p) / trials;
    (is_inside ? inside : outside) = p;
  }
  return inside;
}

TEST(Wilson, AgreesWithTextbookValues) {
  const Interval half = wilson(5, 10);
  EXPECT_NEAR(half.low, 0.2366, 5e-5);
  EXPECT_NEAR(half.high, 0.7634, 5e-5);
  const Interval all = wilson(56, 56);
  EXPECT_NEAR(all.low, 56.0 / (56.0 + 3.8415), 1e-4);
  EXPECT_DOUBLE_EQ(all.high, 1.0);
  EXPECT_DOUBLE_EQ(wilson(0, 84).low, 0.0);
}

TEST(Wilson, SolvesItsEquation) {
  for (const auto& [successes, trials] : {std::pair(1.0, 7.0), std::pair(17.0, 20.0), std::pair(600.0, 812.0)}) {
    const Interval interval = wilson(successes, trials);
    EXPECT_NEAR(interval.low, wilson_bound(successes, trials, true), 1e-9);
    EXPECT_NEAR(interval.high, wilson_bound(successes, trials, false), 1e-9);
  }
}

TEST(Wilson, CoversEverythingWithoutTrialsAndRefusesInvalidCounts) {
  EXPECT_DOUBLE_EQ(wilson(0, 0).low, 0.0);
  EXPECT_DOUBLE_EQ(wilson(0, 0).high, 1.0);
  EXPECT_THROW(wilson(3, 2), Error);
  EXPECT_THROW(wilson(-1, 2), Error);
  EXPECT_THROW(wilson(std::nan(""), 2), Error);
}

TEST(Bootstrap, HasPoissonWeightsOfMeanOne) {
  std::array<double, 4> seen{};
  double sum = 0.0, squares = 0.0, n = 0.0;
  for (std::uint64_t key = 0; key < 500; ++key) {
    for (const std::uint8_t weight : bootstrap_weights(key)) {
      if (weight < seen.size()) seen[weight] += 1.0;
      sum += weight;
      squares += weight * weight;
      n += 1.0;
    }
  }
  EXPECT_NEAR(sum / n, 1.0, 0.01);
  EXPECT_NEAR(squares / n - (sum / n) * (sum / n), 1.0, 0.02);
  EXPECT_NEAR(seen[0] / n, std::exp(-1.0), 0.005);
  EXPECT_NEAR(seen[1] / n, std::exp(-1.0), 0.005);
  EXPECT_NEAR(seen[2] / n, std::exp(-1.0) / 2, 0.005);
  EXPECT_NEAR(seen[3] / n, std::exp(-1.0) / 6, 0.005);
}

TEST(Bootstrap, DependsOnTheKeyAlone) {
  EXPECT_EQ(bootstrap_weights(7), bootstrap_weights(7));
  EXPECT_NE(bootstrap_weights(7), bootstrap_weights(8));
  EXPECT_EQ(frame_key("a", "b"), frame_key("a", "b"));
  EXPECT_NE(frame_key("ab", ""), frame_key("a", "b"));
  EXPECT_NE(frame_key("a", "b"), frame_key("b", "a"));
}

TEST(PercentileInterval, InterpolatesAndIgnoresValuesThatAreNotFinite) {
  std::vector<double> values{std::nan("")};
  for (int i = 100; i >= 0; --i) values.push_back(i);
  const Interval interval = percentile_interval(values);
  EXPECT_DOUBLE_EQ(interval.low, 2.5);
  EXPECT_DOUBLE_EQ(interval.high, 97.5);
  EXPECT_TRUE(std::isnan(percentile_interval({std::nan("")}).low));
}

}  // namespace
}  // namespace vesalius
