#include "metrics/compare_metrics.h"

#include <gmock/gmock.h>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using Verdict = Comparison::Verdict;

/// Returns a metric over `frames` frames whose values have a spread of 0.1, which is the same for every `shift`.
Estimate estimate(Metric metric, double shift, std::uint64_t seed, int frames = 300, const char* set = "a") {
  MetricTable table;
  for (int i = 0; i < frames; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    table.add(frame_key(set, std::to_string(i).c_str()), {{metric, 0.5 + shift + random.normal(0.0, 0.1), 1.0}});
  }
  return table.estimates().front();
}

TEST(Compare, FindsSmallDifferencesOfPairedFrames) {
  const Estimate before = estimate(Metric::mask_iou, 0.0, 1);
  const Estimate after = estimate(Metric::mask_iou, 0.002, 1);  // every frame is slightly better
  EXPECT_EQ(compare(before, after, true).verdict, Verdict::better);
  EXPECT_EQ(compare(after, before, true).verdict, Verdict::worse);
  EXPECT_EQ(compare(before, after, false).verdict, Verdict::same);
  EXPECT_NEAR(compare(before, after, true).difference, 0.002, 1e-9);
}

TEST(Compare, PrefersLowerErrors) {
  const Estimate before = estimate(Metric::joints_error, 0.0, 1);
  const Estimate after = estimate(Metric::joints_error, -0.05, 1);
  EXPECT_EQ(compare(before, after, true).verdict, Verdict::better);
}

TEST(Compare, PrefersBiasesNearerZero) {
  const Estimate high = estimate(Metric::joint_up, 0.0, 1);    // 0.5
  const Estimate low = estimate(Metric::joint_up, -0.8, 1);    // -0.3
  const Estimate lower = estimate(Metric::joint_up, -1.2, 1);  // -0.7
  EXPECT_EQ(compare(high, low, true).verdict, Verdict::better);
  EXPECT_EQ(compare(high, lower, true).verdict, Verdict::worse);
  EXPECT_EQ(compare(lower, low, true).verdict, Verdict::better);
}

TEST(Compare, FindsNoDifferenceOfAnEstimateToItself) {
  const Estimate one = estimate(Metric::mask_iou, 0.0, 1);
  const Comparison same = compare(one, one, true);
  EXPECT_EQ(same.verdict, Verdict::same);
  EXPECT_DOUBLE_EQ(same.interval.low, 0.0);
  EXPECT_DOUBLE_EQ(same.interval.high, 0.0);
}

/// Newcombe (1998), table II, method 10, compares 56/70 with 48/80: 0.2, from 0.0524 to 0.3339.
TEST(Compare, AgreesWithNewcombesExample) {
  const auto share_of = [](double successes, double trials) {
    Estimate share{Metric::people_found, successes / trials};
    share.interval = wilson(successes, trials);
    return share;
  };
  const Comparison result = compare(share_of(48, 80), share_of(56, 70), false);
  EXPECT_NEAR(result.difference, 0.2, 1e-12);
  EXPECT_NEAR(result.interval.low, 0.0524, 1e-4);
  EXPECT_NEAR(result.interval.high, 0.3339, 1e-4);
  EXPECT_EQ(result.verdict, Verdict::better);
}

/// For pairs without a difference, about one interval in twenty may miss 0.
TEST(Compare, SeldomTakesChanceForADifference) {
  int called = 0;
  constexpr int kPairs = 100;
  for (std::uint64_t i = 0; i < kPairs; ++i) {
    const Comparison result =
        compare(estimate(Metric::mask_iou, 0, 2 * i, 60), estimate(Metric::mask_iou, 0, 2 * i + 1, 60), true);
    called += result.verdict == Verdict::same ? 0 : 1;
  }
  EXPECT_LE(called, 14);
  EXPECT_GE(called, 1);
}

}  // namespace
}  // namespace vesalius
