#include "metrics/joint_sight.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "metrics/test_terms.h"

namespace vesalius {
namespace {

using test::value_of;
using testing::ElementsAre;

const Eigen::Vector3f kUnknown = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

/// Returns a frame of a wall at 2 m whose left half is person 0; a pixel is 1 cm^2 there.
TrueFrame half_a_wall() {
  TrueFrame frame;
  frame.frame.camera = {100, 100, 200.F, 200.F, 49.5F, 49.5F};
  frame.frame.depth = DepthImage(100, 100, 2000);
  frame.truth.person = Image<std::uint8_t>(100, 100, kBackground);
  for (int v = 0; v < 100; ++v) std::fill_n(frame.truth.person.row(v), 50, std::uint8_t{0});
  return frame;
}

TEST(JointSight, AsksForThePersonsSurfaceNearby) {
  // The person ends at x = 0. Of a circle of 15 cm about a joint 11 cm to the right of that, a segment of 4 cm height
  // and 57 cm^2 is the person's; at 14 cm to the right one of 7 cm^2.
  const std::vector<Sight> sight =
      joint_sight(half_a_wall(), 0, {{-0.2F, 0, 2}, {0.11F, 0, 2}, {0.14F, 0, 2}, {-0.2F, 0, 2.2F}, kUnknown});
  EXPECT_THAT(sight, ElementsAre(Sight::seen, Sight::seen, Sight::hidden, Sight::hidden, Sight::unknown));
}

TEST(JointSight, CountsOnlyPixelsOfThePersonWithAReading) {
  TrueFrame frame = half_a_wall();
  EXPECT_THAT(joint_sight(frame, 1, {{-0.2F, 0, 2}}), ElementsAre(Sight::hidden));
  std::ranges::fill(frame.frame.depth, std::uint16_t{0});
  EXPECT_THAT(joint_sight(frame, 0, {{-0.2F, 0, 2}}), ElementsAre(Sight::hidden));
  frame.truth.person = {};
  EXPECT_THAT(joint_sight(frame, 0, {{-0.2F, 0, 2}}), ElementsAre(Sight::unknown));
}

TEST(SightTerms, TellSeenFromHiddenJoints) {
  const JointPair pair{{{0, 0, 2}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}},
                       {{0.05F, 0, 2}, {0.2F, 0, 2}, {0, 0.03F, 2}, kUnknown, {0, 0, 2}}};
  const std::vector<float> confidences{0.95F, 1.F, 0.35F, 0.F, 0.31F};
  const MetricTerms terms =
      sight_terms(pair, confidences, {Sight::seen, Sight::seen, Sight::hidden, Sight::hidden, Sight::unknown});
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.seen.at_10cm"), 0.5);
  EXPECT_NEAR(value_of(terms, "joints.seen.error_m"), 0.125, 1e-6);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.hidden.at_10cm"), 0.5);  // one was not found
  EXPECT_NEAR(value_of(terms, "joints.hidden.error_m"), 0.03, 1e-6);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.right_at.90_to_100"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.right_at.30_to_40"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.seen.right_at.90_to_100"), 0.5);
  EXPECT_TRUE(std::isnan(value_of(terms, "joints.seen.right_at.30_to_40")));
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.hidden.right_at.30_to_40"), 1.0);
  EXPECT_TRUE(std::isnan(value_of(terms, "joints.right_at.0_to_10")));
  EXPECT_TRUE(std::isnan(value_of(terms, "joints.hidden.right_at.90_to_100")));
}

TEST(SightTerms, LeaveOutJointsWhoseTruthIsUnknown) {
  EXPECT_TRUE(sight_terms({{kUnknown}, {{0, 0, 1}}}, {0.5F}, {Sight::unknown}).empty());
}

}  // namespace
}  // namespace vesalius
