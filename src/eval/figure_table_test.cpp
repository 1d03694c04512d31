#include "eval/figure_table.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "vesalius/base/error.h"
#include "vesalius/base/random.h"

namespace vesalius {
namespace {

const Estimate& get(const std::vector<Estimate>& estimates, const std::string& name) {
  const Estimate* found = find_estimate(estimates, name);
  if (found == nullptr) throw Error(name + " is missing");
  return *found;
}

TEST(FigureTable, RatioOfSumsAndMeanOfGroups) {
  FigureTable table;
  table.add(1, {{"mask.iou", 0.5, 1.0}, {"pixels.recall.a", 1.0, 4.0}, {"pixels.recall.b", 3.0, 3.0}});
  table.add(2, {{"mask.iou", 0.9, 1.0}, {"pixels.recall.a", 1.0, 0.0}});
  table.add(3, {{"pixels.recall.a", 2.0, 4.0}, {"pixels.recall.c", 0.0, 0.0}});
  const std::vector<Estimate> estimates = table.estimates();
  EXPECT_DOUBLE_EQ(get(estimates, "mask.iou").value, 0.7);
  EXPECT_DOUBLE_EQ(get(estimates, "pixels.recall.a").value, 0.5);
  EXPECT_DOUBLE_EQ(get(estimates, "pixels.mean_recall").value, 0.75);  // of a and b; c never occurred
  EXPECT_EQ(estimates.size(), 4U);
}

TEST(FigureTable, SharesOfTrialsHaveWilsonsInterval) {
  FigureTable table;
  for (std::uint64_t i = 0; i < 10; ++i) table.add(i, {{"people.found", i < 9 ? 1.0 : 0.0, 1.0}});
  const Estimate found = table.estimates().front();
  EXPECT_DOUBLE_EQ(found.interval.low, wilson(9, 10).low);
  EXPECT_DOUBLE_EQ(found.interval.high, wilson(9, 10).high);
}

/// The standard error of a mean is known; the bootstrap's interval must have about 3.92 of it.
TEST(FigureTable, BootstrapIntervalOfAMean) {
  FigureTable table;
  Random random(5);
  constexpr int kFrames = 2000;
  for (int i = 0; i < kFrames; ++i) {
    table.add(static_cast<std::uint64_t>(i), {{"joints.error_m", random.normal(0.1, 0.02), 1.0}});
  }
  const Estimate mean = table.estimates().front();
  const double expected = 2 * 1.96 * 0.02 / std::sqrt(kFrames);
  EXPECT_NEAR(mean.value, 0.1, 0.002);
  EXPECT_NEAR(mean.interval.high - mean.interval.low, expected, 0.25 * expected);
  EXPECT_LT(mean.interval.low, mean.value);
  EXPECT_GT(mean.interval.high, mean.value);
}

TEST(FigureTable, OrderOfFramesDoesNotMatter) {
  FigureTable forwards, backwards;
  const auto terms = [](std::uint64_t i) { return FigureTerms{{"a", static_cast<double>(i), 1.0}}; };
  for (std::uint64_t i = 0; i < 9; ++i) forwards.add(i, terms(i));
  for (std::uint64_t i = 9; i-- > 0;) backwards.add(i, terms(i));
  EXPECT_EQ(forwards.frames_key(), backwards.frames_key());
  EXPECT_EQ(forwards.estimates()[0].replicates, backwards.estimates()[0].replicates);
  backwards.add(9, terms(9));
  EXPECT_NE(forwards.frames_key(), backwards.frames_key());
}

TEST(FigureTable, RefusesWhatIsNotFinite) {
  FigureTable table;
  EXPECT_THROW(table.add(1, {{"a", std::nan(""), 1.0}}), Error);
  EXPECT_THROW(table.add(1, {{"a", 1.0, -1.0}}), Error);
  EXPECT_TRUE(table.estimates().empty());
}

TEST(FigureKind, Directions) {
  EXPECT_TRUE(kind_of("people.found").higher_is_better);
  EXPECT_FALSE(kind_of("people.false").higher_is_better);
  EXPECT_FALSE(kind_of("joint.head.error_m").higher_is_better);
  EXPECT_TRUE(kind_of("joint.head.error_m").metres);
  EXPECT_FALSE(kind_of("pixels.body_on_empty").higher_is_better);
  EXPECT_TRUE(kind_of("joint.head.at_10cm").trials);
  EXPECT_FALSE(kind_of("joints.at_10cm").trials);  // joints of one frame go wrong together
}

}  // namespace
}  // namespace vesalius
