#include "synth/pose/pose_kinds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "synth/pose/floor_contact.h"
#include "synth/pose/judge_pose.h"
#include "synth/pose/pose_sampler.h"

namespace vesalius::synth {
namespace {

/// A kind with the postures that its poses may have.
struct Case {
  const char* name;
  float PoseSamplerOptions::*weight;
  std::optional<Pose> (*draw)(Random&);
  std::set<Posture> postures;
};

using P = Posture;
using O = PoseSamplerOptions;
const Case kCases[] = {
    {"crawling", &O::crawling, kinds::crawling, {P::kneeling}},
    {"getting-up", &O::getting_up, kinds::getting_up, {P::standing, P::sitting, P::lying, P::kneeling}},
    {"turning-over", &O::turning_over, kinds::turning_over, {P::lying}},
    {"falling", &O::falling, kinds::falling, {P::standing, P::sitting, P::lying, P::kneeling}},
    {"sitting-up", &O::sitting_up, kinds::sitting_up, {P::sitting, P::lying}},
    {"lying-varied", &O::lying_varied, kinds::lying_varied, {P::lying}},
    {"picking-up", &O::picking_up, kinds::picking_up, {P::standing, P::sitting, P::lying, P::kneeling}},
    {"drinking", &O::drinking, [](Random& r) { return std::optional(kinds::drinking(r)); }, {P::standing, P::sitting}},
    {"handing", &O::handing, [](Random& r) { return std::optional(kinds::handing(r)); }, {P::standing, P::sitting}},
    {"hands-together",
     &O::hands_together,
     [](Random& r) { return std::optional(kinds::hands_together(r)); },
     {P::standing, P::sitting}},
    {"hands-on-self",
     &O::hands_on_self,
     [](Random& r) { return std::optional(kinds::touching_oneself(r)); },
     {P::standing, P::sitting}},
    {"leaning", &O::leaning, [](Random& r) { return std::optional(kinds::leaning(r)); }, {P::standing, P::sitting}},
};

std::vector<SampledPose> drawn(const Case& kind, int count, float touch_m = kTouch_m) {
  std::vector<SampledPose> poses;
  Random random(7);
  for (int i = 0; i < count; ++i) poses.push_back(sample_pose(only(kind.weight), random, touch_m));
  return poses;
}

bool arms_in_range(const Pose& pose) {
  return arm_in_range(arm_angles(pose, true)) && arm_in_range(arm_angles(pose, false));
}
bool legs_in_range(const Pose& pose) {
  return leg_in_range(leg_angles(pose, true)) && leg_in_range(leg_angles(pose, false));
}

/// Returns the spine's or neck's bend to any side, degrees.
float bend_deg(const Pose& pose, Bone first, Bone second) {
  return (pose[first] * pose[second]).angularDistance(Eigen::Quaternionf::Identity()) * 57.2958F;
}

float height_m(const Pose& pose, Bone bone) { return skin_height_m(pose, bone).value(); }

TEST(PoseKinds, HoldInAtLeastOneOfThreeDraws) {
  constexpr int kDraws = 400;
  for (const Case& kind : kCases) {
    Random random(3);
    int kept = 0;
    for (int i = 0; i < kDraws; ++i) {
      const std::optional<Pose> pose = kind.draw(random);
      kept += pose && arms_in_range(*pose) && !intersects_itself(*pose) ? 1 : 0;
    }
    EXPECT_GE(3 * kept, kDraws) << kind.name;
  }
}

TEST(PoseKinds, KeepJointsInRangeWithoutIntersections) {
  for (const Case& kind : kCases) {
    const std::vector<SampledPose> poses = drawn(kind, 60);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Pose& pose = poses[i].pose;
      EXPECT_TRUE(arms_in_range(pose)) << kind.name << ' ' << i;
      EXPECT_TRUE(legs_in_range(pose)) << kind.name << ' ' << i;
      EXPECT_FALSE(intersects_itself(pose)) << kind.name << ' ' << i;
      EXPECT_LT(bend_deg(pose, Bone::spine, Bone::chest), 100.F) << kind.name << ' ' << i;
      EXPECT_LT(bend_deg(pose, Bone::neck, Bone::head), 85.F) << kind.name << ' ' << i;
      EXPECT_TRUE(kind.postures.contains(poses[i].posture)) << kind.name << ' ' << i << to_string(poses[i].posture);
      EXPECT_GT(largest_angle(pose, poses[(i + 1) % poses.size()].pose), 0.09F) << kind.name << ' ' << i;
    }
  }
}

TEST(PoseKinds, AreTheSameForTheSameSeed) {
  for (const Case& kind : kCases) {
    const std::vector<SampledPose> first = drawn(kind, 5), again = drawn(kind, 5);
    for (std::size_t i = 0; i < first.size(); ++i) {
      for (std::size_t b = 0; b < kBoneCount; ++b) {
        EXPECT_EQ(first[i].pose.local[b].coeffs(), again[i].pose.local[b].coeffs()) << kind.name;
      }
    }
  }
}

/// Returns how many of the bones have skin within 3 cm of the floor.
int carrying(const Pose& pose, std::initializer_list<Bone> bones) {
  return int(std::ranges::count_if(bones, [&](Bone bone) { return height_m(pose, bone) < 0.03F; }));
}

TEST(PoseKinds, CrawlOnKneesAndHandsOrForearms) {
  for (const SampledPose& p : drawn(kCases[0], 200)) {
    const auto on_knee = [&](Bone thigh, Bone shin) { return carrying(p.pose, {thigh, shin}) > 0 ? 1 : 0; };
    const int knees = on_knee(Bone::l_thigh, Bone::l_shin) + on_knee(Bone::r_thigh, Bone::r_shin);
    const int hands = carrying(p.pose, {Bone::l_hand, Bone::r_hand});
    EXPECT_GE(knees, 1);
    EXPECT_GE(hands, 1);
    EXPECT_GE(knees + hands, 3) << "at most one limb is on its way";
    EXPECT_LE(out_of_support_m(p.pose), 0.01F);
  }
}

TEST(PoseKinds, RestOnTheFloor) {
  for (const float O::*weight : {&O::sitting_up, &O::lying_varied, &O::turning_over}) {
    const Case& kind = *std::ranges::find(kCases, weight, &Case::weight);
    for (const SampledPose& p : drawn(kind, 100)) {
      EXPECT_LT(std::min(height_m(p.pose, Bone::pelvis), height_m(p.pose, Bone::chest)), 0.07F) << kind.name;
    }
  }
}

TEST(PoseKinds, StayInBalanceOnTheirWayUp) {
  const Case& kind = *std::ranges::find(kCases, &O::getting_up, &Case::weight);
  std::set<Posture> postures;
  int on_hands = 0;
  for (const SampledPose& p : drawn(kind, 300)) {
    postures.insert(p.posture);
    EXPECT_LT(out_of_support_m(p.pose), 0.1F);
    if (p.posture == Posture::sitting) {
      EXPECT_LT(height_m(p.pose, Bone::pelvis), 0.1F) << "no seat belongs under it";
    }
    on_hands += carrying(p.pose, {Bone::l_hand, Bone::r_hand}) > 0 ? 1 : 0;
  }
  EXPECT_EQ(postures.size(), 4U);
  EXPECT_GT(on_hands, 60);
}

TEST(PoseKinds, GiveNoSeatToPeopleWhoFall) {
  const Case& kind = *std::ranges::find(kCases, &O::falling, &Case::weight);
  for (const SampledPose& p : drawn(kind, 200)) {
    if (p.posture == Posture::sitting) {
      EXPECT_LT(height_m(p.pose, Bone::pelvis), 0.1F);
    }
  }
}

TEST(PoseKinds, PutHandsWhereTheyBelong) {
  const auto between_hands = [](const Pose& pose) {
    const StickFigure f = stick_figure(pose);
    const auto middle = [&](Bone hand) { return (0.5F * (f.head_of(hand) + f.tail_of(hand))).eval(); };
    return (middle(Bone::l_hand) - middle(Bone::r_hand)).norm();
  };
  const Case& together = *std::ranges::find(kCases, &O::hands_together, &Case::weight);
  for (const SampledPose& p : drawn(together, 100)) EXPECT_LT(between_hands(p.pose), 0.16F);
  const Case& drinking = *std::ranges::find(kCases, &O::drinking, &Case::weight);
  int at_mouth = 0;
  for (const SampledPose& p : drawn(drinking, 100)) {
    const StickFigure f = stick_figure(p.pose);
    const Eigen::Vector3f mouth =
        f.head_of(Bone::head) + world_rotations(p.pose)[index(Bone::head)] * Eigen::Vector3f(0.F, 0.02F, 0.11F);
    at_mouth +=
        std::min((f.head_of(Bone::l_hand) - mouth).norm(), (f.head_of(Bone::r_hand) - mouth).norm()) < 0.2F ? 1 : 0;
  }
  EXPECT_GT(at_mouth, 50);
}

TEST(PoseKinds, PickThingsUpInBalance) {
  const Case& kind = *std::ranges::find(kCases, &O::picking_up, &Case::weight);
  int low = 0, stand = 0;
  for (const SampledPose& p : drawn(kind, 200)) {
    if (p.posture != Posture::standing) continue;
    ++stand;
    low += std::min(height_m(p.pose, Bone::l_hand), height_m(p.pose, Bone::r_hand)) < 0.3F ? 1 : 0;
    EXPECT_LT(out_of_support_m(p.pose), 0.06F);
  }
  EXPECT_GT(2 * low, stand);
}

}  // namespace
}  // namespace vesalius::synth
