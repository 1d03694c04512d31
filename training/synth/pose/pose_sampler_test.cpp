#include "synth/pose/pose_sampler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "synth/pose/joint_angles.h"
#include "synth/pose/judge_pose.h"
#include "synth/pose/pose.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Collects the names of the weights, and sets all of them except one to 0.
class OnlyOne : public OptionVisitor {
 public:
  explicit OnlyOne(std::string name) : name_(std::move(name)) {}
  void option(const std::string& name, float& value, const OptionInfo& /*info*/) override {
    names.insert(name);
    value = name == name_ ? 1.F : 0.F;
  }
  void option(const std::string& /*name*/, int& /*value*/, const OptionInfo& /*info*/) override {}
  void option(const std::string& /*name*/, bool& /*value*/, const OptionInfo& /*info*/) override {}
  void option(const std::string& /*name*/, std::string& /*value*/, const OptionInfo& /*info*/) override {}

  std::set<std::string> names;

 private:
  std::string name_;
};

PoseSamplerOptions only(const std::string& name) {
  PoseSamplerOptions options;
  OnlyOne visitor(name);
  visit_options("", options, visitor);
  EXPECT_TRUE(visitor.names.contains(name)) << name;
  return options;
}

std::vector<SampledPose> sampled(const std::string& kind, int count) {
  const PoseSamplerOptions options = only(kind);
  std::vector<SampledPose> out;
  for (int i = 0; i < count; ++i) {
    Random random(5, static_cast<std::uint64_t>(i));
    out.push_back(sample_pose(options, random));
  }
  return out;
}

/// Returns the mean position of a point over poses of a kind.
template <class F>
Vector3f mean(const std::vector<SampledPose>& poses, F&& point) {
  Vector3f sum = Vector3f::Zero();
  for (const SampledPose& p : poses) sum += point(stick_figure(p.pose));
  return sum / static_cast<float>(poses.size());
}

TEST(PoseSampler, DrawsDifferentPossiblePosesWithTheirPosture) {
  const std::map<std::string, Posture> kinds = {
      {"idle", Posture::standing},         {"walking", Posture::standing},
      {"reaching", Posture::standing},     {"waving", Posture::standing},
      {"bending", Posture::standing},      {"arms-crossed", Posture::standing},
      {"arms-behind", Posture::standing},  {"hands-on-hips", Posture::standing},
      {"carrying", Posture::standing},     {"phone", Posture::standing},
      {"squatting", Posture::standing},    {"sitting", Posture::sitting},
      {"floor-sitting", Posture::sitting}, {"lying", Posture::lying},
      {"kneeling", Posture::kneeling}};
  for (const auto& [kind, posture] : kinds) {
    const std::vector<SampledPose> poses = sampled(kind, 100);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_EQ(poses[i].posture, posture) << kind << ' ' << i;
      EXPECT_EQ(classify_posture(poses[i].pose), posture) << kind << ' ' << i;
      EXPECT_FALSE(intersects_itself(poses[i].pose)) << kind << ' ' << i;
      for (const bool left : {true, false})
        EXPECT_TRUE(arm_in_range(arm_angles(poses[i].pose, left))) << kind << ' ' << i;
      EXPECT_GT(largest_angle(poses[i].pose, poses[(i + 1) % poses.size()].pose), 0.02F) << kind << ' ' << i;
    }
  }
}

TEST(PoseSampler, PutsHandsWhereTheKindSays) {
  const auto left_wrist = [](const StickFigure& f) { return f.head_of(Bone::l_hand); };
  const auto right_wrist = [](const StickFigure& f) { return f.head_of(Bone::r_hand); };
  const std::vector<SampledPose> crossed = sampled("arms-crossed", 50);
  EXPECT_LT(mean(crossed, left_wrist).x(), -0.03F) << "left hand to the right";
  EXPECT_GT(mean(crossed, left_wrist).z(), 0.1F);
  EXPECT_GT(mean(crossed, right_wrist).x(), 0.03F);
  EXPECT_LT(mean(sampled("arms-behind", 50), left_wrist).z(), -0.1F);
  const std::vector<SampledPose> idle = sampled("idle", 50);
  EXPECT_GT(mean(idle, left_wrist).x(), 0.2F);
  EXPECT_LT(mean(idle, left_wrist).y(), 0.2F);
  for (const SampledPose& p : sampled("waving", 50)) {
    const StickFigure f = stick_figure(p.pose);
    const float higher = std::max(f.tail_of(Bone::l_hand).y(), f.tail_of(Bone::r_hand).y());
    EXPECT_GT(higher, f.head_of(Bone::chest).y()) << "a hand is up";
  }
}

TEST(PoseSampler, KeepsTheFeetOfStandingPeopleLevel) {
  for (const char* kind : {"idle", "arms-crossed", "hands-on-hips"}) {
    for (const SampledPose& p : sampled(kind, 50)) {
      const StickFigure f = stick_figure(p.pose);
      EXPECT_NEAR(f.head_of(Bone::l_foot).y(), f.head_of(Bone::r_foot).y(), 0.03F) << kind;
      EXPECT_NEAR(f.head_of(Bone::l_foot).y(), f.tail_of(Bone::l_foot).y(), 0.03F) << kind;
    }
  }
}

TEST(PoseSampler, CoversTheRangesOfAllJoints) {
  float lowest = 180.F, highest = 0.F;
  for (const SampledPose& p : sampled("any", 300)) {
    const float elbow = arm_angles(p.pose, true).elbow;
    lowest = std::min(lowest, elbow);
    highest = std::max(highest, elbow);
  }
  EXPECT_LT(lowest, 15.F);
  EXPECT_GT(highest, 135.F);
}

TEST(PoseSampler, IsTheSameForTheSameSeed) {
  Random a(1, 2), b(1, 2), c(1, 3);
  const SampledPose first = sample_pose({}, a), again = sample_pose({}, b), other = sample_pose({}, c);
  for (std::size_t j = 0; j < kBoneCount; ++j) EXPECT_EQ(first.pose.local[j].coeffs(), again.pose.local[j].coeffs());
  EXPECT_GT(largest_angle(first.pose, other.pose), 0.02F);
}

TEST(PoseSampler, DrawsKindsByTheirWeights) {
  PoseSamplerOptions options = only("lying");
  options.idle = 3.F;
  Random random(9);
  int lying = 0;
  for (int i = 0; i < 1000; ++i) lying += sample_pose(options, random).posture == Posture::lying ? 1 : 0;
  EXPECT_NEAR(lying, 250, 55) << "4 standard deviations";
}

/// Collects the weights.
class Weights : public OptionVisitor {
 public:
  void option(const std::string& name, float& value, const OptionInfo& /*info*/) override { weights[name] = value; }
  void option(const std::string& /*name*/, int& /*value*/, const OptionInfo& /*info*/) override {}
  void option(const std::string& /*name*/, bool& /*value*/, const OptionInfo& /*info*/) override {}
  void option(const std::string& /*name*/, std::string& /*value*/, const OptionInfo& /*info*/) override {}

  std::map<std::string, float> weights;
};

TEST(PoseSampler, HasLaterKindsOffSoThatEarlierRecipesGiveTheSamePoses) {
  PoseSamplerOptions options;
  Weights visitor;
  visit_options("", options, visitor);
  for (const char* later : {"crawling", "getting-up", "turning-over", "falling", "sitting-up", "lying-varied",
                            "picking-up", "drinking", "handing", "hands-together", "hands-on-self", "leaning"}) {
    ASSERT_TRUE(visitor.weights.contains(later)) << later;
    EXPECT_EQ(visitor.weights[later], 0.F) << later;
  }
  EXPECT_EQ(visitor.weights.size(), 28U) << "another kind belongs above, with weight 0";
}

TEST(PoseSampler, TakesPosesThatTouchDeeperIfAllowed) {
  constexpr float kDeep_m = 0.06F;
  Random random(6);
  std::vector<SampledPose> poses;
  for (int i = 0; i < 200; ++i) poses.push_back(sample_pose(only("hands-on-self"), random, kDeep_m));
  const auto deep = [](const SampledPose& p) { return intersects_itself(p.pose); };
  EXPECT_GT(std::ranges::count_if(poses, deep), 20);
  for (int i = 0; i < 200; ++i) poses.push_back(draw_pose(poses, 1.F, 0.F, random, kDeep_m));
  for (const SampledPose& p : poses) EXPECT_FALSE(intersects_itself(p.pose, kDeep_m));
}

TEST(PoseSampler, CountsPostures) {
  EXPECT_EQ(posture_counts(sampled("kneeling", 3)), "standing 0, sitting 0, lying 0, kneeling 3");
  EXPECT_EQ(posture_counts({}), "standing 0, sitting 0, lying 0, kneeling 0");
}

TEST(PoseSampler, RefusesInvalidWeights) {
  Random random(1);
  PoseSamplerOptions none = only("idle");
  none.idle = 0.F;
  EXPECT_THAT([&] { sample_pose(none, random); }, ThrowsMessage<UsageError>(HasSubstr("at least one weight above 0")));
  none.idle = -1.F;
  EXPECT_THAT([&] { sample_pose(none, random); }, ThrowsMessage<UsageError>(HasSubstr("weight of idle")));
  PoseSamplerOptions defaults;
  RangeCheck check;
  EXPECT_NO_THROW(visit_options("", defaults, check));
}

std::vector<SampledPose> some_poses(int count) {
  Random random(4);
  std::vector<SampledPose> poses;
  for (int i = 0; i < count; ++i) poses.push_back(sample_pose({}, random));
  return poses;
}

bool same(const Pose& a, const Pose& b, Bone bone) { return a[bone].coeffs() == b[bone].coeffs(); }

/// Returns whether the pose is one of those, apart from its grips.
bool is_one_of(const Pose& pose, const std::vector<SampledPose>& poses) {
  return std::ranges::any_of(poses, [&](const SampledPose& p) { return largest_angle(p.pose, pose) < 1e-3F; });
}

TEST(MixLimbs, TakesOnlyTheGivenLimbs) {
  const std::vector<SampledPose> poses = some_poses(2);
  const Pose &a = poses[0].pose, &b = poses[1].pose;
  const Pose arm = mix_limbs(a, b, {.l_arm = true});
  EXPECT_TRUE(same(arm, b, Bone::l_clavicle) && same(arm, b, Bone::l_hand));
  EXPECT_EQ(arm.l_grip, b.l_grip);
  EXPECT_TRUE(same(arm, a, Bone::r_hand) && same(arm, a, Bone::l_shin) && same(arm, a, Bone::head));
  const Pose legs = mix_limbs(a, b, {.legs = true, .head = true});
  EXPECT_TRUE(same(legs, b, Bone::pelvis) && same(legs, b, Bone::r_foot) && same(legs, b, Bone::neck));
  EXPECT_TRUE(same(legs, a, Bone::chest) && same(legs, a, Bone::l_forearm));
  EXPECT_EQ(legs.l_grip, a.l_grip);
}

TEST(MixLimbs, PutsAllLimbsOnAnotherTrunk) {
  const std::vector<SampledPose> poses = some_poses(2);
  const Pose all = mix_limbs(poses[0].pose, poses[1].pose, {true, true, true, true});
  for (int b = 0; b < kBoneCount; ++b) {
    const auto bone = static_cast<Bone>(b);
    const bool trunk = bone == Bone::spine || bone == Bone::chest;
    EXPECT_TRUE(same(all, poses[trunk ? 0 : 1].pose, bone)) << bone_name(bone);
  }
}

TEST(DrawPose, DrawsPossiblePoses) {
  const std::vector<SampledPose> poses = some_poses(60);
  Random random(8);
  int known = 0;
  for (int i = 0; i < 300; ++i) {
    const SampledPose drawn = draw_pose(poses, 1.F, 0.5F, random);
    EXPECT_FALSE(intersects_itself(drawn.pose));
    EXPECT_EQ(classify_posture(drawn.pose), drawn.posture);
    known += is_one_of(drawn.pose, poses) || is_one_of(mirrored(drawn.pose), poses) ? 1 : 0;
  }
  EXPECT_LT(known, 60) << "most are mixtures";
}

TEST(DrawPose, MirrorsAndMixesWithTheGivenProbabilities) {
  const std::vector<SampledPose> poses = some_poses(60);
  Random random(8);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_one_of(draw_pose(poses, 0.F, 0.F, random).pose, poses));
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_one_of(mirrored(draw_pose(poses, 0.F, 1.F, random).pose), poses));
}

TEST(DrawPose, IsTheSameForTheSameSeedAndRefusesAnEmptyList) {
  const std::vector<SampledPose> poses = some_poses(20);
  Random a(1), b(1);
  const SampledPose first = draw_pose(poses, 0.5F, 0.5F, a), again = draw_pose(poses, 0.5F, 0.5F, b);
  for (std::size_t j = 0; j < kBoneCount; ++j) EXPECT_EQ(first.pose.local[j].coeffs(), again.pose.local[j].coeffs());
  EXPECT_EQ(first.pose.l_grip, again.pose.l_grip);
  EXPECT_THROW(draw_pose({}, 0.5F, 0.5F, a), UsageError);
}

}  // namespace

}  // namespace vesalius::synth
