#include "vesalius/track/track_stance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr float kDegree = std::numbers::pi_v<float> / 180.F;
constexpr double kFrame_s = 1.0 / 30.0;

Posture posture(float trunk_degrees, float pelvis_m, float head_m) {
  Posture posture;
  posture.trunk_rad = trunk_degrees * kDegree;
  posture.pelvis_m = pelvis_m;
  posture.head_m = head_m;
  posture.head_seen = true;
  return posture;
}

const Posture kStanding = posture(5.F, 0.9F, 1.55F);
const Posture kSitting = posture(15.F, 0.52F, 1.05F);
const Posture kBent = posture(75.F, 0.8F, 0.9F);
const Posture kInBed = posture(85.F, 0.6F, 0.65F);
const Posture kOnFloor = posture(85.F, 0.15F, 0.18F);
const Posture kSitsOnFloor = posture(10.F, 0.15F, 0.8F);

/// Shows postures frame by frame and notes what changes.
class StanceOverTime : public testing::Test {
 protected:
  struct Change {
    Stance stance;
    double since_s, told_s;
  };

  void show(const std::optional<Posture>& what, double seconds) {
    for (const double end_s = time_s_ + seconds; time_s_ < end_s - 1e-9; time_s_ += kFrame_s) {
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

 private:
  double time_s_ = 0.0;
};

TEST_F(StanceOverTime, AStanceCountsFromWhenItBegan) {
  show(kStanding, 2.0);
  show(kSitting, 2.0);
  ASSERT_EQ(stances(), (std::vector{Stance::standing, Stance::sitting}));
  EXPECT_NEAR(changes[1].since_s, 2.0, 1e-6);
  EXPECT_NEAR(changes[1].told_s, 2.5, 2.0 * kFrame_s);
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
  EXPECT_NEAR(changes[1].since_s, 3.0, 1e-6);
  EXPECT_NEAR(changes[1].told_s, 4.0, 2.0 * kFrame_s);
}

TEST_F(StanceOverTime, WhoLiesDownSlowlyHasNotFallenButAfterLong) {
  show(kStanding, 2.0);
  show(std::nullopt, 3.0);
  show(kOnFloor, 9.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::lying}));
  show(kOnFloor, 2.0);
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(changes[2].stance, Stance::fallen);
  EXPECT_NEAR(changes[2].since_s, 5.0, 1e-6);
}

TEST_F(StanceOverTime, WhoSatOnTheFloorLiesDownAndHasNotFallen) {
  show(kSitting, 1.0);
  show(kSitsOnFloor, 4.0);
  show(kOnFloor, 5.0);
  EXPECT_EQ(stance.stance(), Stance::lying);
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
  Posture upright, flat;
  upright.trunk_rad = 5.F * kDegree;
  flat.trunk_rad = 88.F * kDegree;
  show(upright, 3.0);
  EXPECT_TRUE(changes.empty());
  show(flat, 30.0);
  EXPECT_EQ(stances(), std::vector{Stance::lying});
}

TEST_F(StanceOverTime, AChildStandsAsAnAdultDoes) {
  show(posture(5.F, 0.5F, 0.86F), 1.0);
  EXPECT_EQ(stance.stance(), Stance::standing);
}

TEST_F(StanceOverTime, KneesTellWhatTheHipsLeaveOpen) {
  Posture between = posture(5.F, 0.55F, 1.F);
  between.knee_m = 0.45F;
  show(between, 1.0);
  EXPECT_EQ(stance.stance(), Stance::sitting);
  between = posture(5.F, 0.8F, 1.47F);
  between.knee_m = 0.42F;
  show(between, 1.0);
  EXPECT_EQ(stance.stance(), Stance::standing);
}

/// A skeleton with these parts seen.
Skeleton skeleton_with(const std::vector<std::pair<const char*, Vector3f>>& parts) {
  Skeleton skeleton;
  skeleton.parts.resize(paper_body().parts.size());
  for (const auto& [name, centre] : parts) {
    SkeletonPart& part = skeleton.parts[static_cast<std::size_t>(paper_body().find_part(name))];
    part.state = State::observed;
    part.centre = centre;
  }
  return skeleton;
}

TEST(PostureOf, MeasuresHeightsOverTheFloor) {
  // The camera is 1.2 m high and tilted down by 30 degrees.
  const Vector3f up(0.F, -std::cos(30.F * kDegree), -std::sin(30.F * kDegree));
  const Vector3f hips = 2.5F * Vector3f::UnitZ(), chest = hips + 0.4F * up, head = hips + 0.7F * up;
  const Skeleton skeleton = skeleton_with({{"l_hips", hips}, {"r_chest", chest}, {"l_face_top", head}});
  const std::optional<Posture> found = posture_of(skeleton, paper_body(), up, 1.4F);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->trunk_rad, 0.F, 1e-3F);
  EXPECT_NEAR(*found->pelvis_m, 1.4F - 1.25F, 1e-5F);
  EXPECT_NEAR(*found->head_m, 1.4F - 1.25F + 0.7F, 1e-5F);
  EXPECT_TRUE(found->head_seen);
  EXPECT_FALSE(found->knee_m);
  const std::optional<Posture> without = posture_of(skeleton, paper_body(), up, std::nullopt);
  ASSERT_TRUE(without);
  EXPECT_FALSE(without->pelvis_m);
}

TEST_F(StanceOverTime, HipsThatAreOnlyFittedTellWhoSitsButNeverAlarm) {
  Posture sitting = kSitting, in_bed = kInBed, on_floor = kOnFloor;
  sitting.hips_seen = in_bed.hips_seen = on_floor.hips_seen = false;
  show(kStanding, 2.0);
  show(sitting, 2.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::sitting}));
  show(on_floor, 12.0);
  show(in_bed, 2.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::sitting, Stance::unknown}));
}

TEST(PostureOf, TakesHipsFromTheFittedBodyWhereNoneAreSeen) {
  const Vector3f up = -Vector3f::UnitY(), fitted(0.F, 0.2F, 2.F);
  const Skeleton trunk = skeleton_with({{"l_chest", {0.F, -0.2F, 2.F}}, {"l_face_top", {0.F, -0.5F, 2.F}}});
  EXPECT_FALSE(posture_of(trunk, paper_body(), up, 0.6F));
  const std::optional<Posture> found = posture_of(trunk, paper_body(), up, 0.6F, fitted);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->hips_seen);
  EXPECT_NEAR(*found->pelvis_m, 0.4F, 1e-5F);
  EXPECT_NEAR(*found->head_m, 1.1F, 1e-5F);
  const Skeleton with_hips = skeleton_with({{"l_hips", {0.F, 0.1F, 2.F}}, {"l_face_top", {0.F, -0.5F, 2.F}}});
  const std::optional<Posture> seen = posture_of(with_hips, paper_body(), up, 0.6F, fitted);
  ASSERT_TRUE(seen);
  EXPECT_TRUE(seen->hips_seen);
  EXPECT_NEAR(*seen->pelvis_m, 0.5F, 1e-5F) << "what is seen counts";
  EXPECT_FALSE(posture_of({}, paper_body(), up, 0.6F, fitted)) << "a body without anything seen is no evidence";
}

TEST(TrustedHips, AreTheUpperEndOfThePelvisIfThatIsTrusted) {
  const FleshModel& flesh = builtin_flesh();
  FittedBody fitted;
  fitted.bones.resize(flesh.bones.size());
  FittedBone& pelvis = fitted.bones[flesh.find_bone("pelvis")];
  EXPECT_FALSE(trusted_hips(fitted, flesh));
  pelvis.state = State::predicted;
  pelvis.tail_confidence = 0.6F;
  pelvis.tail = {0.1F, 0.3F, 2.F};
  ASSERT_TRUE(trusted_hips(fitted, flesh));
  EXPECT_EQ(*trusted_hips(fitted, flesh), pelvis.tail);
  pelvis.tail_confidence = 0.4F;
  EXPECT_FALSE(trusted_hips(fitted, flesh));
}

TEST(PostureOf, NeedsUpAndSeenPartsOfTheTrunk) {
  const Vector3f up = -Vector3f::UnitY();
  const Skeleton whole = skeleton_with({{"l_hips", {0.F, 0.F, 2.F}}, {"neck", {0.F, -0.5F, 2.F}}});
  EXPECT_TRUE(posture_of(whole, paper_body(), up, 1.F));
  EXPECT_FALSE(posture_of(whole, paper_body(), std::nullopt, 1.F));
  EXPECT_FALSE(posture_of(skeleton_with({{"neck", {0.F, -0.5F, 2.F}}}), paper_body(), up, 1.F));
  EXPECT_FALSE(posture_of(skeleton_with({{"l_hips", {0.F, 0.F, 2.F}}}), paper_body(), up, 1.F));
  Skeleton guessed = whole;
  for (SkeletonPart& part : guessed.parts) {
    if (part.state == State::observed) part.state = State::predicted;
  }
  EXPECT_FALSE(posture_of(guessed, paper_body(), up, 1.F));
  EXPECT_FALSE(posture_of({}, paper_body(), up, 1.F));
}

}  // namespace
}  // namespace vesalius
