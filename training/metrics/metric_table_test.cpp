#include "metrics/metric_table.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "vesalius/base/random.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::ElementsAre;

MetricId recall(int place, const char* part) { return {Metric::pixel_recall, place, part}; }

std::vector<std::string> names(const std::vector<Estimate>& estimates) {
  std::vector<std::string> all;
  for (const Estimate& estimate : estimates) all.push_back(estimate.id.name());
  return all;
}

TEST(MetricTable, GivesRatiosOfSumsAndMeansOfFamilies) {
  MetricTable table;
  table.add(1, {{Metric::mask_iou, 0.5, 1.0}, {recall(0, "a"), 1.0, 4.0}, {recall(1, "b"), 3.0, 3.0}});
  table.add(2, {{Metric::mask_iou, 0.9, 1.0}, {recall(0, "a"), 1.0, 0.0}});
  table.add(3, {{recall(0, "a"), 2.0, 4.0}, {recall(2, "c"), 0.0, 0.0}});
  const std::vector<Estimate> estimates = table.estimates();
  EXPECT_THAT(names(estimates), ElementsAre("mask.iou", "pixels.recall.a", "pixels.recall.b", "pixels.mean_recall"));
  EXPECT_DOUBLE_EQ(estimates[0].value, 0.7);
  EXPECT_DOUBLE_EQ(estimates[1].value, 0.5);
  EXPECT_DOUBLE_EQ(estimates[3].value, 0.75);  // the mean of a and b, as c never occurred
  EXPECT_EQ(find_estimate(estimates, Metric::pixel_recall, "b"), &estimates[2]);
  EXPECT_EQ(find_estimate(estimates, Metric::pixel_recall, "c"), nullptr);
  EXPECT_EQ(find_estimate(estimates, Metric::people_found), nullptr);
}

TEST(MetricTable, ListsEstimatesInTheOrderOfTheMetrics) {
  MetricTable table;
  table.add(1,
            {{Metric::joints_error, 1.0}, {{Metric::distance, 3, "3-4m"}, 1.0}, {{Metric::heading, 2, "back"}, 1.0}});
  table.add(2,
            {{{Metric::distance, 4, "4m-"}, 1.0}, {{Metric::heading, 0, "front"}, 1.0}, {Metric::people_found, 1.0}});
  table.add(3, {{{Metric::distance, 0, "0-1m"}, 1.0}, {{Metric::heading, 1, "side"}, 1.0}});
  EXPECT_THAT(names(table.estimates()), ElementsAre("people.found", "distance.0-1m", "distance.3-4m", "distance.4m-",
                                                    "heading.front", "heading.side", "heading.back", "joints.error_m"));
}

TEST(MetricTable, TakesAMemberWithSeveralPlacesAsOneMetric) {
  MetricTable table;
  table.add(1, {{{Metric::joint_error, 1, "head"}, 0.1}, {{Metric::joint_error, 0, "neck"}, 0.1}});
  table.add(2, {{{Metric::joint_error, 0, "head"}, 0.3}, {{Metric::joint_error, 1, "neck"}, 0.1}});
  const std::vector<Estimate> estimates = table.estimates();
  EXPECT_THAT(names(estimates), ElementsAre("joint.head.error_m", "joint.neck.error_m"));
  EXPECT_DOUBLE_EQ(estimates[0].value, 0.2);
}

TEST(MetricTable, GivesSharesOfTrialsWilsonsInterval) {
  MetricTable table;
  for (std::uint64_t i = 0; i < 10; ++i) table.add(i, {{Metric::people_found, i < 9 ? 1.0 : 0.0, 1.0}});
  const Estimate found = table.estimates().front();
  EXPECT_DOUBLE_EQ(found.interval.low, wilson(9, 10).low);
  EXPECT_DOUBLE_EQ(found.interval.high, wilson(9, 10).high);
  EXPECT_EQ(text_with_interval(found), "90.00 % (59.58 to 98.21)");
}

/// The standard error of a mean is known, and the bootstrap's interval must be about 3.92 times as wide.
TEST(MetricTable, GivesMeansTheirIntervalByTheBootstrap) {
  MetricTable table;
  Random random(5);
  constexpr int kFrames = 2000;
  for (int i = 0; i < kFrames; ++i) {
    table.add(static_cast<std::uint64_t>(i), {{Metric::joints_error, random.normal(0.1, 0.02), 1.0}});
  }
  const Estimate mean = table.estimates().front();
  const double expected = 2 * 1.96 * 0.02 / std::sqrt(kFrames);
  EXPECT_NEAR(mean.value, 0.1, 0.002);
  EXPECT_NEAR(mean.interval.high - mean.interval.low, expected, 0.25 * expected);
  EXPECT_LT(mean.interval.low, mean.value);
  EXPECT_GT(mean.interval.high, mean.value);
}

TEST(MetricTable, DoesNotDependOnTheOrderOfFrames) {
  MetricTable forwards, backwards;
  const auto terms = [](std::uint64_t i) { return MetricTerms{{Metric::mask_iou, static_cast<double>(i), 1.0}}; };
  for (std::uint64_t i = 0; i < 9; ++i) forwards.add(i, terms(i));
  for (std::uint64_t i = 9; i-- > 0;) backwards.add(i, terms(i));
  EXPECT_EQ(forwards.frames_key(), backwards.frames_key());
  EXPECT_EQ(forwards.estimates()[0].replicates, backwards.estimates()[0].replicates);
  backwards.add(9, terms(9));
  EXPECT_NE(forwards.frames_key(), backwards.frames_key());
}

TEST(MetricTable, RefusesTermsThatAreNotFinite) {
  MetricTable table;
  EXPECT_THROW(table.add(1, {{Metric::mask_iou, std::nan(""), 1.0}}), Error);
  EXPECT_THROW(table.add(1, {{Metric::mask_iou, 1.0, -1.0}}), Error);
  EXPECT_TRUE(table.estimates().empty());
}

TEST(MetricTable, MeansRootsOfProductsOverTheMembersOfOneFamily) {
  MetricTable table;
  table.add(1, {{{Metric::track_det_a_at, 0, "0.05"}, 1.0, 4.0},
                {{Metric::track_ass_a_at, 0, "0.05"}, 1.0, 1.0},
                {{Metric::track_det_a_at, 1, "0.10"}, 0.0, 4.0}});
  const std::vector<Estimate> estimates = table.estimates();
  EXPECT_DOUBLE_EQ(find_estimate(estimates, Metric::track_hota)->value, 0.25);  // sqrt(1/4 * 1) and 0
}

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

TEST(Metric, IsFoundByItsName) {
  std::set<std::string> names;
  for (const MetricInfo& metric : kMetrics) {
    const std::string parameter = metric.is_family() ? "l_hand" : "";
    const std::string name = MetricId(metric.metric, 3, parameter).name();
    EXPECT_TRUE(names.insert(name).second) << name << " twice";
    const auto read = parse_metric(name);
    ASSERT_TRUE(read) << name;
    EXPECT_EQ(read->metric, metric.metric) << name;
    EXPECT_EQ(read->parameter, parameter);
  }
}

TEST(Metric, HasAUniqueTitle) {
  std::set<std::string_view> titles;
  for (const MetricInfo& metric : kMetrics) {
    EXPECT_FALSE(metric.title.empty()) << metric.name;
    EXPECT_TRUE(titles.insert(metric.title).second) << metric.title << " twice";
  }
}

TEST(Metric, IsNotFoundByOtherNames) {
  for (const char* name :
       {"", "people", "people.found.", "posture.", "joint..at_10cm", "joint.head", "*", "mask.iou "}) {
    EXPECT_FALSE(parse_metric(name)) << name;
  }
}

TEST(Metric, MayHaveAnyParameterInAFamily) {
  EXPECT_EQ(MetricId(Metric::joint_at_10cm, 0, "head").name(), "joint.head.at_10cm");
  EXPECT_EQ(MetricId(Metric::distance, 0, "4m-").name(), "distance.4m-");
  EXPECT_EQ(parse_metric("joint.a.at_10cm.at_10cm")->parameter, "a.at_10cm");
}

TEST(Metric, IsBetterWhenLowerForErrorsAndFalsePeople) {
  std::set<std::string_view> lower;
  for (const MetricInfo& metric : kMetrics) {
    if (metric.direction == MetricDirection::lower_is_better) lower.insert(metric.name);
  }
  for (const std::string_view name : lower) {
    const bool is_wrong =
        name.find("error") != name.npos || name.find("mirrored") != name.npos || name.find("swapped") != name.npos;
    const bool is_unsteady = name.find("jitter") != name.npos || name == "bones.spread";
    const bool is_broken = name.starts_with("track.");
    EXPECT_TRUE(is_wrong || is_unsteady || is_broken || name == "people.false" || name == "frames.empty_with_person" ||
                name == "pixels.body_on_empty")
        << name;
  }
  EXPECT_TRUE(lower.contains("people.false") && lower.contains("joint.*.error_m") && lower.contains("given.mirrored"));
  EXPECT_FALSE(lower.contains("given.right") || lower.contains("sides.order"));
}

TEST(Metric, IsBestAtZeroForBiases) {
  for (const MetricInfo& metric : kMetrics) {
    EXPECT_EQ(metric.direction == MetricDirection::nearer_zero_is_better, metric.unit == MetricUnit::millimetres);
  }
  EXPECT_STREQ(better_word(Metric::joint_up), "zero");
}

TEST(Metric, HasWilsonsIntervalOnlyForSeparateTrials) {
  EXPECT_EQ(info(Metric::people_found).kind, MetricKind::trials);
  EXPECT_EQ(info(Metric::joint_at_10cm).kind, MetricKind::trials);
  EXPECT_EQ(info(Metric::joints_at_10cm).kind, MetricKind::ratio);  // errors of the joints of one frame are correlated
}

TEST(Metric, IsWrittenWithItsUnit) {
  EXPECT_EQ(metric_text(Metric::people_found, 0.972), "97.20 %");
  EXPECT_EQ(metric_text(Metric::joints_error, 0.0412), "0.041 m");
  EXPECT_EQ(metric_text(Metric::people_false, 0.0125), "0.013 a frame");
  EXPECT_EQ(metric_text(Metric::joint_up, -12.4), "-12 mm");
  EXPECT_EQ(metric_text(Metric::track_ids, 1.25), "1.25 a person");
  EXPECT_EQ(metric_text(Metric::joints_jitter, 5120.4), "5120 mm/s^2");
  EXPECT_EQ(metric_difference_text(Metric::people_found, 0.012), "+1.20 %");
  EXPECT_EQ(metric_difference_text(Metric::joints_error, -0.003), "-0.003 m");
  EXPECT_EQ(metric_difference_text(Metric::people_false, 0.0), "+0.000");
  EXPECT_EQ(metric_difference_text(Metric::track_switches, -0.5), "-0.50");
}

}  // namespace

}  // namespace vesalius
