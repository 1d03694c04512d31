#include "vesalius/track/track_stance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr double kFrame_s = 1.0 / 30.0;

/// A posture of which all is seen, of somebody of 1.7 m.
struct Seen {
  float top_m, chest_m, hips_m, trunk_up, thighs_up, pitch_m, vertical_m;

  operator Posture() const {  // NOLINT(google-explicit-constructor): it is one
    return {1.7F, top_m, chest_m, hips_m, trunk_up, thighs_up, pitch_m, vertical_m};
  }
};

const Posture kStanding = Seen{1.68F, 1.25F, 0.95F, 0.99F, 0.97F, 0.3F, 1.15F};
const Posture kSitting = Seen{1.26F, 0.86F, 0.6F, 0.95F, 0.2F, 0.3F, 0.75F};
const Posture kBent = Seen{1.1F, 0.95F, 0.92F, 0.4F, 0.97F, 0.02F, 0.75F};
const Posture kInBed = Seen{0.82F, 0.68F, 0.63F, 0.1F, 0.05F, 0.04F, 0.15F};
const Posture kOnFloor = Seen{0.32F, 0.2F, 0.15F, 0.1F, 0.05F, 0.04F, 0.15F};
const Posture kSitsOnFloor = Seen{0.85F, 0.48F, 0.15F, 0.9F, -0.2F, 0.28F, 0.5F};

/// Shows postures frame by frame and notes what changes.
class StanceOverTime : public testing::Test {
 protected:
  struct Change {
    Stance stance;
    double since_s, told_s;
  };

  void show(const std::optional<Posture>& what, double seconds) {
    for (const double end_s = time_s_ + seconds; time_s_ < end_s - 1e-9; time_s_ += frame_s) {
      if (const auto changed = stance.update(what, time_s_)) {
        changes.push_back({changed->first, changed->second, time_s_});
      }
    }
  }
  std::vector<Stance> stances() const {
    std::vector<Stance> all;
    for (const Change& change : changes) all.push_back(change.stance);
    return all;
  }

  TrackStance stance;
  std::vector<Change> changes;
  double frame_s = kFrame_s;

 private:
  double time_s_ = 0.0;
};

TEST_F(StanceOverTime, AStanceCountsFromWhenItBegan) {
  show(kStanding, 2.0);
  show(kSitting, 2.0);
  ASSERT_EQ(stances(), (std::vector{Stance::standing, Stance::sitting}));
  EXPECT_NEAR(changes[1].since_s, 2.0, 1.5 * kFrame_s);
  EXPECT_NEAR(changes[1].told_s, 2.6, 0.3);
  EXPECT_EQ(stance.stance(), Stance::sitting);
}

TEST_F(StanceOverTime, AMomentChangesNothing) {
  show(kStanding, 2.0);
  for (int i = 0; i < 10; ++i) {
    show(kSitting, 0.3);
    show(kStanding, 0.3);
  }
  EXPECT_EQ(stances(), std::vector{Stance::standing});
}

TEST_F(StanceOverTime, WhoBendsOverStands) {
  show(kStanding, 1.0);
  show(kBent, 3.0);
  show(kStanding, 1.0);
  EXPECT_EQ(stances(), std::vector{Stance::standing});
}

TEST_F(StanceOverTime, WhoLiesOnTheFloorWithinTwoSecondsHasFallen) {
  show(kStanding, 2.0);
  show(std::nullopt, 1.0);  // nobody sees how
  show(kOnFloor, 3.0);
  ASSERT_EQ(stances(), (std::vector{Stance::standing, Stance::fallen}));
  EXPECT_NEAR(changes[1].since_s, 3.0, 1.5 * kFrame_s);
  EXPECT_NEAR(changes[1].told_s, 3.6, 0.4);
}

TEST_F(StanceOverTime, WhoFellIsToldThoughNeitherHipsNorLegsAreSeen) {
  Posture unclear = kOnFloor;
  unclear.hips_m = unclear.trunk_up = unclear.thighs_up = unclear.pitch_m = std::nullopt;
  show(kStanding, 2.0);
  show(unclear, 2.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::fallen}));
}

TEST_F(StanceOverTime, AFewWrongFramesChangeNothing) {
  show(kStanding, 1.0);
  for (int i = 0; i < 30; ++i) {
    show(kStanding, 0.2);
    show(kOnFloor, 0.1);
  }
  EXPECT_EQ(stances(), std::vector{Stance::standing});
}

TEST_F(StanceOverTime, FewFramesASecondTellAsMuch) {
  frame_s = 1.0 / 8.0;
  show(kStanding, 2.0);
  show(kOnFloor, 2.0);
  show(kStanding, 2.0);
  show(kSitting, 2.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::fallen, Stance::standing, Stance::sitting}));
  for (const Change& change : changes) EXPECT_LT(change.told_s - change.since_s, 1.1);
}

TEST_F(StanceOverTime, WhoLiesDownSlowlyHasNotFallenButAfterLong) {
  show(kStanding, 2.0);
  show(std::nullopt, 3.0);
  show(kOnFloor, 9.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::lying}));
  show(kOnFloor, 2.0);
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(changes[2].stance, Stance::fallen);
  EXPECT_NEAR(changes[2].since_s, 5.0, 1.5 * kFrame_s);
}

TEST_F(StanceOverTime, WhoSatOnTheFloorLiesDownAndHasNotFallen) {
  show(kSitting, 1.0);
  show(kSitsOnFloor, 4.0);
  show(kOnFloor, 5.0);
  EXPECT_EQ(stance.stance(), Stance::lying);
}

TEST_F(StanceOverTime, WhoSitsDownOnTheFloorForAMomentAndThenLiesHasNotFallen) {
  show(kStanding, 2.0);
  show(kSitsOnFloor, 1.0);
  show(kOnFloor, 3.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::sitting, Stance::lying}));
}

TEST_F(StanceOverTime, WhoSinksToTheFloorHasFallen) {
  show(kStanding, 2.0);
  show(kSitsOnFloor, 0.3);
  show(kOnFloor, 3.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::fallen}));
}

TEST_F(StanceOverTime, WhoIsHeldKeepsTheStance) {
  show(kStanding, 2.0);
  show(kOnFloor, 2.0);
  EXPECT_TRUE(stance.down());
  for (double time_s = 4.0; time_s < 20.0; time_s += 0.1) {
    stance.hold(time_s);
    EXPECT_FALSE(stance.update({}, time_s));
  }
  EXPECT_EQ(stance.stance(), Stance::fallen);
}

TEST_F(StanceOverTime, WhoGoesToBedLies) {
  show(kStanding, 2.0);
  show(kSitting, 1.0);
  show(kInBed, 20.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::sitting, Stance::lying}));
}

TEST_F(StanceOverTime, WhoGetsUpAgainStands) {
  show(kStanding, 2.0);
  show(kOnFloor, 3.0);
  show(kStanding, 1.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::fallen, Stance::standing}));
}

TEST_F(StanceOverTime, WithoutEvidenceNobodyKnows) {
  show(kStanding, 1.0);
  show(std::nullopt, 4.0);
  EXPECT_EQ(stance.stance(), Stance::standing);
  show(std::nullopt, 2.0);
  EXPECT_EQ(stance.stance(), Stance::unknown);
  EXPECT_NEAR(changes.back().since_s, 1.0, 0.1);
}

TEST_F(StanceOverTime, WithoutFloorOnlyLyingIsKnownAndNobodyFalls) {
  const auto without_floor = [](Posture posture) {
    posture.top_m = posture.chest_m = posture.hips_m = std::nullopt;
    return posture;
  };
  const Posture upright = without_floor(kStanding), flat = without_floor(kOnFloor);
  show(upright, 3.0);
  EXPECT_TRUE(changes.empty());
  show(flat, 30.0);
  EXPECT_EQ(stances(), std::vector{Stance::lying});
}

TEST_F(StanceOverTime, AChildStandsAsAnAdultDoes) {
  show(Posture{0.95F, 0.94F, 0.69F, 0.52F, 0.98F, 0.95F, 0.17F, 0.62F}, 1.0);
  EXPECT_EQ(stance.stance(), Stance::standing);
}

}  // namespace
}  // namespace vesalius
