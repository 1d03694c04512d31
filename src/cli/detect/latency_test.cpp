#include "cli/detect/latency.h"

#include <gmock/gmock.h>

#include <chrono>
#include <thread>

namespace vesalius::cli {
namespace {

using testing::DoubleEq;
using testing::HasSubstr;

TEST(Latency, IsZeroWithoutTimes) { EXPECT_EQ(summarise({}).longest, 0.0); }

TEST(Latency, TakesNearestRanks) {
  std::vector<double> ms;
  for (int i = 100; i >= 1; --i) ms.push_back(i);
  const Latency l = summarise(ms);
  EXPECT_EQ(l.median, 50.0);
  EXPECT_EQ(l.p95, 95.0);
  EXPECT_EQ(l.p99, 99.0);
  EXPECT_EQ(l.longest, 100.0);
  EXPECT_EQ(l.mean, 50.5);
  EXPECT_EQ(summarise({7.0}).p99, 7.0);
  EXPECT_EQ(summarise({1.0, 2.0, 3.0}).median, 2.0);
}

TEST(FrameTimes, SumsStagesWithoutReadingAndWriting) {
  FrameTimes times;
  StageTimes stages;
  stages[Stage::label] = 2.0;
  stages[Stage::people] = 0.5;
  times.add(stages, 10.0, -1.0);
  EXPECT_EQ(times.frames(), 1U);
  EXPECT_THAT(times.detect().median, DoubleEq(2.5));
  const auto rows = times.rows();
  ASSERT_EQ(rows.size(), kStageNames.size() + 2);
  EXPECT_EQ(rows.front().name, "read");
  EXPECT_EQ(rows.back().name, "detect");
  EXPECT_THAT(table(times), HasSubstr("label            2.00"));
}

TEST(StageClock, AddsToStagesAndAcceptsNull) {
  StageTimes times;
  StageClock clock(&times);
  clock.lap(Stage::grow);
  clock.lap(Stage::grow);
  EXPECT_GE(times[Stage::grow], 0.0);
  EXPECT_EQ(times.total(), times[Stage::grow]);
  StageClock(nullptr).lap(Stage::label);
}

TEST(StageClock, DividesElapsedTimeAmongParallelStages) {
  StageTimes times;
  StageClock clock(&times);
  const double passed = elapsed_ms([] { std::this_thread::sleep_for(std::chrono::milliseconds(4)); });
  EXPECT_GE(passed, 4.0);
  clock.lap({Stage::planes, Stage::label}, {1.0, 3.0});
  EXPECT_GE(times.total(), passed);
  EXPECT_NEAR(times[Stage::label], 3.0 * times[Stage::planes], 1e-9);
  StageClock(nullptr).lap({Stage::planes, Stage::label}, {0.0, 0.0});
}

}  // namespace
}  // namespace vesalius::cli
