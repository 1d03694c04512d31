#include "vesalius/fit/flesh_model.h"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "vesalius/error.h"
#include "vesalius/fit/test_bad_toml.h"

namespace vesalius {
namespace {

using testing::StartsWith;
using testing::ThrowsMessage;

// A trunk with a pair of legs. The tests depend on its line numbers.
constexpr const char* kSmall = R"(shapes = 1
[[bone]]
name = "trunk"
axis = "y"
stations = [0.0, 0.5, 1.0]
mean = [0, 0, 0, 0, 0.5, 0, 0, 0, 0.15, 0.1, 0, 0, 0.15, 0.1, 0, 0, 0.15, 0.1]
shapes = [[0, 0, 0, 0, 0.05, 0, 0, 0, 0.01, 0.01, 0, 0, 0.01, 0.01, 0, 0, 0.01, 0.01]]
low = [0, 0, 0]
high = [0, 0, 0]
[[bone]]
name = "l_leg"
parent = "trunk"
axis = "y"
stations = [0.0, 0.5, 1.0]
mean = [0.1, 0, 0, 0.02, -0.8, 0, 0.01, 0.03, 0.07, 0.08, 0, 0, 0.06, 0.06, 0, 0, 0.05, 0.05]
shapes = [[0, 0, 0, 0, -0.1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]]
low = [-1, -0.2, -0.3]
high = [2, 0.4, 0.5]
[[limb]]
bones = ["l_leg"]
[[limb.component]]
weight = 0.25
mean = [0.1, 0.2, 0.3]
covariance = [0.04, 0.01, 0.09, 0.02, 0.03, 0.16]
[[limb.component]]
weight = 0.75
mean = [0.5, 0, 0]
covariance = [0.04, 0, 0.09, 0, 0, 0.16]
)";

Eigen::VectorXd shape_of(const FleshModel& model, double first) {
  Eigen::VectorXd shape = Eigen::VectorXd::Zero(model.shapes);
  shape[0] = first;
  return shape;
}

TEST(FleshModel, HasBonesWhoseRightMirrorTheLeft) {
  const FleshModel& flesh = builtin_flesh();
  EXPECT_EQ(flesh.bone_count(), 19);
  EXPECT_EQ(flesh.find_bone("pelvis"), 0);
  EXPECT_EQ(flesh.find_bone("tail"), -1);
  EXPECT_EQ(std::ranges::count_if(flesh.bones, [](const FleshBone& bone) { return bone.name.starts_with("l_"); }), 7);
  for (int b = 0; b < flesh.bone_count(); ++b) {
    const FleshBone& bone = flesh.bones[b];
    SCOPED_TRACE(bone.name);
    ASSERT_GE(bone.mirror, 0);
    const FleshBone& other = flesh.bones[bone.mirror];
    EXPECT_EQ(other.mirror, b);
    EXPECT_LT(bone.parent, b);
    EXPECT_EQ(bone.parent < 0, b == 0);
    EXPECT_EQ(other.parent, bone.parent < 0 ? -1 : flesh.bones[bone.parent].mirror);
    EXPECT_EQ(bone.name.substr(1), other.name.substr(1));
    // Bones on the middle line are their own mirror image.
    EXPECT_EQ(mirrored(bone.mean, bone.axis), other.mean);
    for (int k = 0; k < flesh.shapes; ++k) EXPECT_EQ(mirrored(bone.shapes[k], bone.axis), other.shapes[k]);
    for (int i = 0; i < 3; ++i) EXPECT_LE(bone.low[i], bone.high[i]);
  }
  const FleshBone& left = flesh.bones[flesh.find_bone("l_upper_arm")];
  EXPECT_EQ(left.axis, 0);
  EXPECT_GT(left.mean[3], 0.2F) << "x is to the person's left";
}

TEST(FleshModel, LimbsKnowEveryBoneButTheRoot) {
  const FleshModel& flesh = builtin_flesh();
  std::vector<bool> known(flesh.bones.size(), false);
  for (const LimbPrior& limb : flesh.limbs) {
    double sum = 0.0;
    for (const LimbPrior::Component& component : limb.components) sum += static_cast<double>(component.weight);
    EXPECT_NEAR(sum, 1.0, 1e-3);
    EXPECT_TRUE(std::ranges::is_sorted(limb.components, std::greater<>(), &LimbPrior::Component::weight));
    for (const int bone : limb.bones) known[bone] = true;
  }
  for (std::size_t b = 1; b < known.size(); ++b) EXPECT_TRUE(known[b]) << flesh.bones[b].name;
}

TEST(FleshModel, StatureIsThatOfPeople) {
  const FleshModel& flesh = builtin_flesh();
  const double usual = stature(flesh, shape_of(flesh, 0.0));
  EXPECT_GT(usual, 1.5);
  EXPECT_LT(usual, 1.9);
  EXPECT_GT(stature(flesh, shape_of(flesh, 1.0)), usual + 0.03);
  EXPECT_LT(stature(flesh, shape_of(flesh, -1.0)), usual - 0.03);
}

TEST(FleshModel, IsReadAsWritten) {
  const FleshModel model = parse_flesh_model(kSmall, "small");
  ASSERT_EQ(model.bone_count(), 3);
  const FleshBone& left = model.bones[1];
  const FleshBone& right = model.bones[2];
  EXPECT_EQ(right.name, "r_leg");
  EXPECT_EQ(right.parent, 0);
  EXPECT_EQ(left.mirror, 2);
  EXPECT_EQ(model.bones[0].mirror, 0);
  EXPECT_EQ(right.mean[0], -0.1F);
  EXPECT_EQ(right.mean[3], -0.02F);
  EXPECT_EQ(right.mean[4], -0.8F);
  EXPECT_EQ(right.mean[6], -0.01F);
  EXPECT_EQ(right.mean[7], 0.03F);
  EXPECT_EQ(right.mean[8], 0.07F);
  EXPECT_EQ(right.low, (std::array{-1.F, -0.4F, -0.5F}));
  EXPECT_EQ(right.high, (std::array{2.F, 0.2F, 0.3F}));
  // 0.5 m of trunk over 0.8 m of legs; a standard deviation adds 0.05 and 0.1 m.
  EXPECT_NEAR(stature(model, shape_of(model, 0.0)), 1.3, 1e-6);
  EXPECT_NEAR(stature(model, shape_of(model, 2.0)), 1.6, 1e-6);
  EXPECT_NEAR(numbers_of(left, shape_of(model, 2.0))[4], -1.F, 1e-6F);
}

TEST(FleshModel, PriorsMeasureMahalanobisDistance) {
  const FleshModel model = parse_flesh_model(kSmall, "small");
  ASSERT_EQ(model.limbs.size(), 2U);
  EXPECT_EQ(model.limbs[1].bones, std::vector<int>{2});
  ASSERT_EQ(model.limbs[0].components.size(), 2U);
  EXPECT_EQ(model.limbs[0].components[0].weight, 0.75F) << "the most usual first";
  EXPECT_NEAR(model.limbs[0].components[0].log_density, std::log(0.75) - std::log(0.2 * 0.3 * 0.4), 1e-6);
  Eigen::Matrix3d covariance;
  covariance << 0.04, 0.01, 0.02, 0.01, 0.09, 0.03, 0.02, 0.03, 0.16;
  const Eigen::Vector3d sign(1.0, -1.0, -1.0);
  for (int side = 0; side < 2; ++side) {
    const LimbPrior::Component& component = model.limbs[side].components[1];
    const Eigen::Matrix3d flip =
        side == 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : Eigen::Matrix3d(sign.asDiagonal());
    const Eigen::Matrix3d expected = flip * covariance.inverse() * flip;
    EXPECT_TRUE((component.whitening.transpose() * component.whitening).isApprox(expected, 1e-5));
    EXPECT_TRUE(component.whitening.isLowerTriangular());
    EXPECT_TRUE(component.mean.isApprox(flip * Eigen::Vector3d(0.1, 0.2, 0.3), 1e-6));
  }
}

TEST(FleshModel, ErrorsNameFileLineAndExpectation) {
  test::expect_refused(
      kSmall,
      {
          test::BadToml{"shapes = 1", "shapes = 0", 1, "shapes"},
          test::BadToml{"name = \"trunk\"", "name = \"l_trunk\"", 2, "middle line"},
          test::BadToml{"axis = \"y\"", "axis = \"w\"", 2, "expected x, y or z"},
          test::BadToml{"stations = [0.0, 0.5, 1.0]", "stations = [0.0, 0.5, 0.5]", 2, "expected rising numbers"},
          test::BadToml{"0.5, 0, 0, 0, 0.15", "0, 0, 0, 0, 0.15", 2, "tail away from the head"},
          test::BadToml{"0.05, 0.05]", "0.05]", 15, "mean: expected 18 numbers, found 17"},
          test::BadToml{"0.05, 0.05]", "0.05, nan]", 15, "mean"},
          test::BadToml{"[0, 0, 0, 0, -0.1, 0, ", "[0, 0, 0, -0.1, 0, ", 16, "expected lists of 18 numbers"},
          test::BadToml{"shapes = [[0, 0, 0, 0, -0.1", "shapes = [[0], [0, 0, 0, 0, -0.1", 16, "expected 1 lists"},
          test::BadToml{"low = [-1", "low = [3", 10, "low: expected at most \"high\""},
          test::BadToml{"name = \"l_leg\"", "name = \"r_leg\"", 10, "expected no right side"},
          test::BadToml{"name = \"l_leg\"", "name = \"trunk\"", 10, "given twice"},
          test::BadToml{"parent = \"trunk\"", "parent = \"tail\"", 12, "\"tail\": expected a bone above"},
          test::BadToml{"bones = [\"l_leg\"]", "bones = [\"l_arm\"]", 20, "\"l_arm\": expected a bone above"},
          test::BadToml{"bones = [\"l_leg\"]", "bones = []", 19, "expected at least one"},
          test::BadToml{"weight = 0.25", "weight = 0", 22, "weight"},
          test::BadToml{"mean = [0.1, 0.2, 0.3]", "mean = [0.1, 0.2]", 23, "expected 3 numbers, found 2"},
          test::BadToml{"[0.04, 0.01, 0.09", "[0.04, 0.01", 24, "expected 6 numbers, found 5"},
          test::BadToml{"[0.04, 0.01, 0.09", "[0.04, 0.07, 0.09", 21, "expected a positive definite matrix"},
          test::BadToml{"[0.04, 0.01, 0.09", "[-0.04, 0.01, 0.09", 21, "expected a positive definite matrix"},
          test::BadToml{"low = [0, 0, 0]", "lower = [0, 0, 0]", 8, "lower"},
      },
      [](const std::string& text, const char* name) { parse_flesh_model(text, name); });
  EXPECT_THAT([] { parse_flesh_model("shapes = [", "some.toml"); }, ThrowsMessage<Error>(StartsWith("some.toml:1:")));
  EXPECT_THROW(parse_flesh_model("", "some.toml"), Error);
}

}  // namespace
}  // namespace vesalius
