#include "learn/fit_joints.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>

#include "vesalius/base/body_heading.h"
#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;
using testing::ElementsAre;
using testing::SizeIs;
using testing::UnorderedElementsAre;

int part(const char* name) { return paper_body().find_part(name); }

Vector3f scattered(Random& random, double sigma_m) {
  const auto draw = [&] { return static_cast<float>(random.normal(0.0, sigma_m)); };
  const float x = draw(), y = draw();
  return {x, y, draw()};
}

/// Returns a person whose parts stand about their height on a body: legs low, arms and head high.
Skeleton somebody(Random& random) {
  const Vector3f at(static_cast<float>(random.uniform(-1.0, 1.0)), 0.F, static_cast<float>(random.uniform(1.5, 3.5)));
  Skeleton skeleton;
  for (const BodyPart& p : paper_body().parts) {
    SkeletonPart placed;
    placed.state = State::observed;
    placed.centre = at + Vector3f(0.F, p.upper_body ? -0.3F : 0.4F, 0.F) + scattered(random, 0.12);
    placed.confidence = 1.F;
    skeleton.parts.push_back(placed);
  }
  return skeleton;
}

std::vector<JointSample> samples_of(const JointDefinition& truth, int count, double noise_m) {
  Random random(7);
  std::vector<JointSample> samples;
  for (int i = 0; i < count; ++i) {
    const Skeleton skeleton = somebody(random);
    const Vector3f up = body_up(given_centres(skeleton), paper_body());
    samples.push_back({skeleton, derive_joint(truth, skeleton, up).position + scattered(random, noise_m)});
  }
  return samples;
}

const JointDefinition kStart{"l_shoulder", {part("l_upper_arm")}, {1.F}, 0.F, 0.F};

TEST(FitJoint, FindsWhatMadeTheSamples) {
  const JointDefinition truth{"l_shoulder", {part("l_upper_arm"), part("l_chest")}, {0.7F, 0.3F}, 0.05F, 0.08F};
  const JointDefinition fitted = fit_joint(kStart, samples_of(truth, 300, 0.01), paper_body());
  EXPECT_EQ(fitted.name, "l_shoulder");
  ASSERT_THAT(fitted.parts, UnorderedElementsAre(part("l_upper_arm"), part("l_chest")));
  EXPECT_NEAR(fitted.weights[0], fitted.parts[0] == part("l_upper_arm") ? 0.7F : 0.3F, 0.03F);
  EXPECT_NEAR(fitted.depth_offset_m, 0.05F, 0.005F);
  EXPECT_NEAR(fitted.up_offset_m, 0.08F, 0.005F);
}

TEST(FitJoint, IsNotMovedByPeopleWithSwappedArms) {
  const JointDefinition truth{"l_shoulder", {part("l_upper_arm")}, {1.F}, 0.05F, 0.08F};
  std::vector<JointSample> samples = samples_of(truth, 400, 0.01);
  for (std::size_t i = 0; i < samples.size(); i += 5) samples[i].truth += Vector3f(0.35F, 0.1F, 0.F);
  const JointDefinition fitted = fit_joint(kStart, samples, paper_body());
  EXPECT_NEAR(fitted.depth_offset_m, 0.05F, 0.01F);
  EXPECT_NEAR(fitted.up_offset_m, 0.08F, 0.01F);
}

TEST(FitJoint, HasFewPartsAndASumOfOne) {
  JointDefinition truth{"l_shoulder", {part("l_upper_arm"), part("l_elbow")}, {1.3F, -0.3F}, 0.05F, 0.F};
  for (const double noise_m : {0.0, 0.05}) {
    const JointDefinition fitted = fit_joint(kStart, samples_of(truth, 200, noise_m), paper_body());
    EXPECT_LE(fitted.parts.size(), 3U);
    EXPECT_NEAR(std::accumulate(fitted.weights.begin(), fitted.weights.end(), 0.F), 1.F, 1e-5F);
  }
}

/// Returns people of all statures with an arm that points anywhere.
std::vector<JointSample> with_arms(int count, double noise_m) {
  Random random(9);
  std::vector<JointSample> samples;
  for (int i = 0; i < count; ++i) {
    Skeleton skeleton = somebody(random);
    const Vector3f along = scattered(random, 1.0).normalized() * float(random.uniform(0.08, 0.16));
    const Vector3f elbow = skeleton.parts[part("l_elbow")].centre;
    skeleton.parts[part("l_forearm")].centre = elbow + along + scattered(random, noise_m);
    skeleton.parts[part("l_hand")].state = State::none;
    samples.push_back({std::move(skeleton), elbow + 1.7F * along});
  }
  return samples;
}

TEST(FitJoint, LiesBeyondALimbThatPointsAnywhere) {
  const JointDefinition start{"l_wrist", {part("l_forearm")}, {1.F}, 0.F, 0.F};
  const JointDefinition fitted = fit_joint(start, with_arms(400, 0.01), paper_body());
  ASSERT_THAT(fitted.parts, UnorderedElementsAre(part("l_forearm"), part("l_elbow")));
  EXPECT_NEAR(fitted.weights[0], fitted.parts[0] == part("l_forearm") ? 1.7F : -0.7F, 0.05F);
  EXPECT_NEAR(fitted.depth_offset_m, 0.F, 0.005F);
}

TEST(FitJoint, HasAnOffsetAlongTheBodyOnlyWhereThatSaves) {
  JointDefinition truth{"l_shoulder", {part("l_upper_arm")}, {1.F}, 0.05F, 0.F};
  EXPECT_EQ(fit_joint(kStart, samples_of(truth, 300, 0.02), paper_body()).up_offset_m, 0.F);
  truth.up_offset_m = 0.03F;
  EXPECT_NEAR(fit_joint(kStart, samples_of(truth, 300, 0.02), paper_body()).up_offset_m, 0.03F, 0.005F);
}

TEST(FitJoint, GivesBothSidesOfTheMiddleOneWeight) {
  const JointDefinition spine{"spine", {part("l_hips"), part("r_hips")}, {0.5F, 0.5F}, 0.F, 0.F};
  const std::vector<int> parts{part("l_hips"), part("r_hips"), part("l_chest"), part("r_chest")};
  const JointDefinition truth{"spine", parts, {0.35F, 0.35F, 0.15F, 0.15F}, 0.1F, 0.F};
  const JointDefinition fitted = fit_joint(spine, samples_of(truth, 300, 0.01), paper_body());
  ASSERT_THAT(fitted.parts, UnorderedElementsAre(parts[0], parts[1], parts[2], parts[3]));
  EXPECT_EQ(fitted.weights[0], fitted.weights[1]);
  EXPECT_NEAR(fitted.weights[0], 0.35F, 0.02F);
}

TEST(FitJoint, KeepsOneWithoutSamplesOrParts) {
  const std::vector<JointSample> few = samples_of({"l_shoulder", {part("neck")}, {1.F}, 0.1F, 0.F}, 99, 0.0);
  EXPECT_THAT(fit_joint(kStart, few, paper_body()).parts, ElementsAre(part("l_upper_arm")));
  EXPECT_THAT(fit_joint({"l_ear", {}, {}, 0.F, 0.F}, samples_of(kStart, 200, 0.0), paper_body()).parts, SizeIs(0));
}

TEST(FitJoint, PrefersTheOwnPartToOneThatMorePeopleHave) {
  const JointDefinition foot{"l_foot", {part("l_foot")}, {1.F}, 0.F, 0.F};
  std::vector<JointSample> samples = samples_of(foot, 600, 0.02);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    SkeletonPart& own = samples[i].skeleton.parts[part("l_foot")];
    if (i % 4 == 1) own.state = State::predicted;
    if (i % 4 > 1) own.state = State::none;
  }
  EXPECT_THAT(fit_joint(foot, samples, paper_body()).parts, ElementsAre(part("l_foot")));
}

TEST(Mirrored, ExchangesLeftAndRight) {
  Random random(3);
  const Skeleton skeleton = somebody(random);
  const JointDefinition other = mirrored(kStart, paper_body());
  EXPECT_THAT(other.parts, ElementsAre(part("r_upper_arm")));
  const Vector3f up = body_up(given_centres(skeleton), paper_body());
  EXPECT_EQ(derive_joint(other, mirrored(skeleton, paper_body()), up).position,
            derive_joint(kStart, skeleton, up).position);
}

/// Returns people whose elbows and heads lie 5 cm behind those parts.
std::vector<KnownPerson> people(int count) {
  Random random(5);
  std::vector<KnownPerson> all;
  for (int i = 0; i < count; ++i) {
    KnownPerson person{somebody(random), {}, {"l_elbow", "r_elbow"}, {}, {}};
    for (const std::string& name : person.joint_names) {
      const Vector3f surface = person.skeleton.parts[paper_body().find_part(name)].centre;
      person.joints.push_back(surface + 0.05F * surface.normalized());
    }
    all.push_back(std::move(person));
  }
  return all;
}

TEST(FitJointSets, FitsBothSidesTogetherInEverySetThatHasTheJoints) {
  const std::vector<JointSet> fitted = fit_joint_sets(people(60), paper_body());  // too few for one side alone
  ASSERT_THAT(fitted, SizeIs(3));
  for (std::size_t s = 0; s < fitted.size(); ++s) {
    const std::vector<JointDefinition>& before = paper_body().joint_sets[s].joints;
    ASSERT_EQ(fitted[s].joints.size(), before.size());
    for (std::size_t j = 0; j < before.size(); ++j) {
      const JointDefinition& joint = fitted[s].joints[j];
      EXPECT_EQ(joint.name, before[j].name);
      if (joint.name == "l_elbow" || joint.name == "r_elbow") {
        EXPECT_THAT(joint.parts, ElementsAre(part(joint.name.c_str())));
        EXPECT_NEAR(joint.depth_offset_m, 0.05F, 0.002F);
      } else {
        EXPECT_EQ(joint.parts, before[j].parts);
      }
    }
  }
}

TEST(FitJointSets, FitsOnlyTheSetThatIsCompared) {
  std::vector<KnownPerson> known = people(60);
  for (KnownPerson& person : known) person.joint_set = "coco17";
  const std::vector<JointSet> fitted = fit_joint_sets(known, paper_body());
  ASSERT_THAT(fitted, SizeIs(1));
  EXPECT_EQ(fitted[0].name, "coco17");
}

TEST(FitJointSets, FitsPartsToTheirCentres) {
  BodyModel body = paper_body();
  JointSet& centres = body.joint_sets.emplace_back();
  centres.name = "centres";
  for (int p = 0; p < body.part_count(); ++p) centres.joints.push_back({body.parts[p].name, {p}, {1.F}, 0.F, 0.F});
  std::vector<KnownPerson> known = people(120);
  for (KnownPerson& person : known) {
    for (const SkeletonPart& p : person.skeleton.parts) {
      person.part_centres.push_back(p.centre + 0.08F * p.centre.normalized());
    }
  }
  const std::vector<JointSet> fitted = fit_joint_sets(known, body);
  ASSERT_THAT(fitted, SizeIs(4));
  EXPECT_NEAR(fitted[3].joints[part("l_elbow")].depth_offset_m, 0.08F, 0.002F);
  EXPECT_NEAR(fitted[2].joints[7].depth_offset_m, 0.05F, 0.002F);  // coco17's l_elbow: the joint, not the part
}

}  // namespace
}  // namespace vesalius
