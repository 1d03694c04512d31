#include "metrics/metric.h"

#include <gmock/gmock.h>

#include <set>

namespace vesalius {
namespace {

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
