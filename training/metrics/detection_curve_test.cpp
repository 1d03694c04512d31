#include "metrics/detection_curve.h"

#include <gmock/gmock.h>

#include <cmath>

namespace vesalius {
namespace {

/// Returns four frames with three people. Two people are found, one of them poorly; two proposals show nobody.
DetectionLog by_hand() {
  DetectionLog log;
  log.frames = 4;
  log.expected = 3;
  log.proposals = {
      {0.9F, 20, true, {25, 20, 17, 15}}, {0.4F, 6, true, {10, 4, 10, 4}}, {0.7F, 5, false, {}}, {0.2F, 9, false, {}}};
  return log;
}

TEST(DetectionCurve, OverPartsAgreesWithCountingByHand) {
  const auto curve = sweep_parts(by_hand(), 25, 0.3);
  ASSERT_EQ(curve.size(), 25U);
  EXPECT_DOUBLE_EQ(curve[0].threshold, 1.0);
  EXPECT_DOUBLE_EQ(curve[3].rate, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[3].false_per_frame, 0.25);
  EXPECT_DOUBLE_EQ(curve[3].part_rate, 24.0 / 35.0);
  EXPECT_DOUBLE_EQ(curve[3].upper_part_rate, 19.0 / 27.0);
  EXPECT_DOUBLE_EQ(curve[5].false_per_frame, 0.0);  // 6 parts
  EXPECT_DOUBLE_EQ(curve[5].rate, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[6].rate, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[6].part_rate, 0.8);
  EXPECT_DOUBLE_EQ(curve[20].rate, 0.0);
  EXPECT_TRUE(std::isnan(curve[20].part_rate));
}

TEST(DetectionCurve, OverScoreAgreesWithCountingByHand) {
  const auto curve = sweep_score(by_hand(), 10, 6);
  ASSERT_EQ(curve.size(), 11U);
  EXPECT_DOUBLE_EQ(curve[0].rate, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[0].false_per_frame, 0.25);
  EXPECT_DOUBLE_EQ(curve[3].false_per_frame, 0.0);
  EXPECT_DOUBLE_EQ(curve[5].rate, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[10].rate, 0.0);
}

TEST(DetectionCurve, FallsWithItsThreshold) {
  for (const auto& curve : {sweep_parts(by_hand(), 25, 0.0), sweep_score(by_hand(), 50, 1)}) {
    for (std::size_t i = 1; i < curve.size(); ++i) {
      EXPECT_LE(curve[i].rate, curve[i - 1].rate);
      EXPECT_LE(curve[i].false_per_frame, curve[i - 1].false_per_frame);
    }
  }
}

TEST(DetectionCurve, HasNoRateWithoutPeople) {
  DetectionLog log;
  log.frames = 2;
  EXPECT_TRUE(std::isnan(sweep_parts(log, 1, 0.0)[0].rate));
  EXPECT_DOUBLE_EQ(sweep_parts(log, 1, 0.0)[0].false_per_frame, 0.0);
}

}  // namespace
}  // namespace vesalius
