#include "vesalius/track/track_stance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
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

TEST_F(StanceOverTime, WhoFellIsToldByThePixelsAlone) {
  Posture pixels;
  pixels.top_m = kOnFloor.top_m;
  pixels.vertical_m = kOnFloor.vertical_m;
  show(kStanding, 2.0);
  show(pixels, 2.0);
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::fallen}));
  EXPECT_TRUE(stance.down());
}

TEST_F(StanceOverTime, PixelsAloneTellNothingOfWhoWasNeverSeen) {
  Posture pixels;
  pixels.top_m = kOnFloor.top_m;
  pixels.vertical_m = kOnFloor.vertical_m;
  show(pixels, 20.0);
  EXPECT_EQ(stances(), std::vector<Stance>{}) << "it may be a bag";
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
  ASSERT_EQ(stances(), (std::vector{Stance::standing, Stance::fallen, Stance::standing}));
  EXPECT_LT(changes[2].told_s, 5.0 + 10.5 * kFrame_s) << "an alarm ends soon";
}

TEST_F(StanceOverTime, WhoLiesAndIsMistakenForAMomentStillLies) {
  show(kStanding, 2.0);
  show(kOnFloor, 3.0);
  for (int i = 0; i < 10; ++i) {
    show(kStanding, 0.1);
    show(kOnFloor, 0.5);
  }
  EXPECT_EQ(stances(), (std::vector{Stance::standing, Stance::fallen}));
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

using Eigen::Vector3f;

constexpr int kWidth = 64, kHeight = 48;
const Vector3f kUp = -Vector3f::UnitY();

Frame frame_at(float z_m) {
  Frame frame;
  frame.camera = {kWidth, kHeight, 50.F, 50.F, 31.5F, 23.5F};
  frame.depth = DepthImage(kWidth, kHeight, static_cast<std::uint16_t>(1000.F * z_m));
  return frame;
}

/// A person of whom these parts are seen.
Person person_with(const std::vector<std::pair<const char*, Vector3f>>& parts) {
  Person person;
  person.skeleton.parts.resize(paper_body().parts.size());
  for (const auto& [name, centre] : parts) {
    SkeletonPart& part = person.skeleton.parts[static_cast<std::size_t>(paper_body().find_part(name))];
    part.state = State::observed;
    part.centre = centre;
  }
  return person;
}

/// The person with the pixels of a box as mask.
Person covering(Person person, const Box& box) {
  person.mask = Mask(kWidth, kHeight, 0);
  for (int v = box.v; v < box.v + box.height; ++v) {
    for (int u = box.u; u < box.u + box.width; ++u) person.mask(u, v) = 1;
  }
  person.box = bounding_box(person.mask);
  return person;
}

TEST(PostureOf, MeasuresHeightsOverTheFloor) {
  // The camera is 1.4 m high and tilted down by 30 degrees.
  constexpr float kTilt = 30.F * std::numbers::pi_v<float> / 180.F;
  const Vector3f up(0.F, -std::cos(kTilt), -std::sin(kTilt));
  const Vector3f hips = 2.5F * Vector3f::UnitZ(), chest = hips + 0.4F * up, head = hips + 0.7F * up;
  const Vector3f knee = hips - 0.3F * Vector3f::UnitX();
  const Person person = person_with({{"l_hips", hips}, {"r_chest", chest}, {"l_face_top", head}, {"l_knee", knee}});
  const std::optional<Posture> found = posture_of(person, frame_at(2.F), paper_body(), up, 1.4F);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found->hips_m, 1.4F - 1.25F, 1e-5F);
  EXPECT_NEAR(*found->chest_m, 1.4F - 1.25F + 0.4F, 1e-5F);
  EXPECT_NEAR(*found->pitch_m, 0.3F, 1e-5F);
  EXPECT_NEAR(*found->trunk_up, 1.F, 1e-5F);
  EXPECT_NEAR(*found->thighs_up, 0.F, 1e-5F);
  EXPECT_FALSE(found->top_m) << "nobody knows which pixels are the person's";
  const std::optional<Posture> without = posture_of(person, frame_at(2.F), paper_body(), up, std::nullopt);
  ASSERT_TRUE(without);
  EXPECT_FALSE(without->hips_m || without->chest_m);
  EXPECT_NEAR(*without->trunk_up, 1.F, 1e-5F);
}

TEST(PostureOf, MeasuresThePixelsUnlessTheBorderCutsThemOff) {
  // At 2 m a pixel is 4 cm high, and row 23.5 is level with the camera, 1 m above the floor.
  const Person person = person_with({{"l_chest", {0.F, 0.F, 2.F}}});
  const auto posture = [&](const Box& box, const Vector3f& up) {
    return posture_of(covering(person, box), frame_at(2.F), paper_body(), up, 1.F).value();
  };
  const Posture inside = posture({20, 10, 8, 26}, kUp);
  EXPECT_NEAR(*inside.top_m, 1.F + 0.04F * 13.5F, 0.05F);
  EXPECT_NEAR(*inside.vertical_m, 0.8F * 0.04F * 26.F, 0.06F);
  const Posture no_head = posture({20, 0, 8, 26}, kUp);
  EXPECT_FALSE(no_head.top_m || no_head.vertical_m);
  const Posture no_feet = posture({20, 22, 8, 26}, kUp);
  EXPECT_TRUE(no_feet.top_m);
  EXPECT_FALSE(no_feet.vertical_m);
  const Posture rolled = posture({0, 10, 26, 8}, Vector3f::UnitX());
  EXPECT_TRUE(rolled.top_m) << "up is to the right";
  EXPECT_FALSE(rolled.vertical_m);
}

TEST(PostureOf, TakesHipsAndKneesOfTheFittedBodyWhereItIsTrusted) {
  const FleshModel& flesh = builtin_flesh();
  FittedBody fitted;
  fitted.stature_m = 1.55F;
  fitted.bones.resize(flesh.bones.size());
  const auto place = [&](const char* bone, const Vector3f& tail, float confidence) {
    FittedBone& placed = fitted.bones[static_cast<std::size_t>(flesh.find_bone(bone))];
    placed.state = State::predicted;
    placed.tail = tail;
    placed.tail_confidence = confidence;
  };
  place("pelvis", {0.F, 0.2F, 2.F}, 0.6F);
  place("l_thigh", {0.F, 0.6F, 2.F}, 0.7F);
  place("r_thigh", {0.F, 0.2F, 1.6F}, 0.4F);
  const Person trunk = person_with({{"l_chest", {0.F, -0.2F, 2.F}}, {"l_face_top", {0.F, -0.5F, 2.F}}});
  const Frame frame = frame_at(2.F);
  EXPECT_FALSE(posture_of(trunk, frame, paper_body(), kUp, 0.6F)->hips_m);
  const PosedBody posed{fitted, flesh};
  const Posture found = posture_of(trunk, frame, paper_body(), kUp, 0.6F, posed).value();
  EXPECT_EQ(found.stature_m, 1.55F);
  EXPECT_NEAR(*found.hips_m, 0.4F, 1e-5F);
  EXPECT_NEAR(*found.thighs_up, 1.F, 1e-5F) << "of the trusted knee alone";
  const Person hips = person_with({{"l_hips", {0.F, 0.1F, 2.F}}, {"l_face_top", {0.F, -0.5F, 2.F}}});
  EXPECT_NEAR(*posture_of(hips, frame, paper_body(), kUp, 0.6F, posed)->hips_m, 0.5F, 1e-5F) << "what is seen counts";
  place("pelvis", {0.F, 0.2F, 2.F}, 0.4F);
  EXPECT_FALSE(posture_of(trunk, frame, paper_body(), kUp, 0.6F, posed)->hips_m);
}

TEST(PostureOf, NeedsSeenPartsOfTheUpperBodyOrPixelsNearTheFloor) {
  const Frame frame = frame_at(2.F);
  const Vector3f at(0.F, 0.F, 2.F);
  const auto posture = [&](const Person& person, std::optional<float> height_m = 1.F) {
    return posture_of(person, frame, paper_body(), kUp, height_m);
  };
  EXPECT_TRUE(posture(person_with({{"neck", at}})));
  const Person legs = person_with({{"l_hips", at}, {"l_knee", at}});
  EXPECT_FALSE(posture(legs));
  // At 2 m a pixel is 4 cm high, and row 23.5 is level with the camera, 1 m above the floor.
  const Box inside{20, 36, 8, 8}, high{20, 28, 8, 12}, cut{20, 0, 8, 40};
  const std::optional<Posture> pixels = posture(covering(legs, inside));
  ASSERT_TRUE(pixels);
  EXPECT_TRUE(pixels->top_m && pixels->vertical_m);
  EXPECT_FALSE(pixels->chest_m || pixels->pitch_m || pixels->trunk_up);
  EXPECT_FALSE(posture(covering(legs, high))) << "the trunk may be hidden above them";
  EXPECT_FALSE(posture(covering(legs, cut))) << "who knows what is above the border";
  EXPECT_FALSE(posture(covering(legs, inside), std::nullopt)) << "nor how high they are without floor";
  Person guessed = person_with({{"neck", at}});
  for (SkeletonPart& part : guessed.skeleton.parts) {
    if (part.state == State::observed) part.state = State::predicted;
  }
  EXPECT_FALSE(posture(guessed));
  EXPECT_FALSE(posture({}));
}

}  // namespace

}  // namespace vesalius
