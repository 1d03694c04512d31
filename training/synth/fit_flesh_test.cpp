#include "synth/fit_flesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vesalius/base/test_threads.h"
#include "vesalius/fit/flesh_model.h"

namespace vesalius::synth {
namespace {

Recipe small_recipe() {
  Recipe recipe;
  recipe.body.kind = "builtin";
  recipe.body.count = 6;
  return recipe;
}

FleshFitOptions small_options() {
  FleshFitOptions options;
  options.bodies = 6;
  options.poses = 300;
  options.shapes = 2;
  options.components = 2;
  return options;
}

TEST(FitFlesh, WritesAFleshModel) {
  const Generator generator(small_recipe(), {}, paper_body(), 7);
  const FleshModel flesh = parse_flesh_model(fitted_flesh_toml(generator, small_options()), "fitted");
  EXPECT_EQ(flesh.shapes, 2);
  // The same bones as the built-in model has, in the same order, so that both serve alike.
  ASSERT_EQ(flesh.bone_count(), builtin_flesh().bone_count());
  for (int b = 0; b < flesh.bone_count(); ++b) {
    EXPECT_EQ(flesh.bones[b].name, builtin_flesh().bones[b].name);
    EXPECT_EQ(flesh.bones[b].parent, builtin_flesh().bones[b].parent);
    EXPECT_EQ(flesh.bones[b].axis, builtin_flesh().bones[b].axis);
    for (int s = 0; s < FleshBone::kStations; ++s) {
      EXPECT_GT(flesh.bones[b].mean[6 + 4 * s + 2], 0.F) << flesh.bones[b].name;
      EXPECT_GT(flesh.bones[b].mean[6 + 4 * s + 3], 0.F) << flesh.bones[b].name;
    }
  }
  const double height = stature(flesh, Eigen::VectorXd::Zero(2));
  EXPECT_GT(height, 1.4);
  EXPECT_LT(height, 2.0);
  ASSERT_EQ(flesh.limbs.size(), builtin_flesh().limbs.size());
  for (const LimbPrior& limb : flesh.limbs) {
    double sum = 0.0;
    for (const LimbPrior::Component& component : limb.components) sum += static_cast<double>(component.weight);
    EXPECT_NEAR(sum, 1.0, 0.01);
  }
}

TEST(FitFlesh, MeasuresTheBodiesThatItIsGiven) {
  const Generator generator(small_recipe(), {}, paper_body(), 7);
  const FleshModel flesh = parse_flesh_model(fitted_flesh_toml(generator, small_options()), "fitted");
  for (const Bone bone : {Bone::l_thigh, Bone::l_shin, Bone::l_upper_arm, Bone::l_forearm}) {
    float sum = 0.F;
    for (int i = 0; i < 6; ++i) {
      const PosedBody posed = generator.body(i).pose(Pose{});
      for (const Bone side : {bone, mirror(bone)}) {
        sum += (posed.ends[index(side)] - posed.joints[index(side)]).norm() / 12.F;
      }
    }
    const FleshBone& fitted = flesh.bones[flesh.find_bone(bone_name(bone))];
    const float length = std::hypot(fitted.mean[3], fitted.mean[4], fitted.mean[5]);
    EXPECT_NEAR(length, sum, 0.005F) << bone_name(bone);
  }
}

TEST(FitFlesh, HasTheSameTextForAnyNumberOfThreads) {
  std::string first;
  for_threads({1, 4}, [&] {
    const Generator generator(small_recipe(), {}, paper_body(), 7);
    const std::string text = fitted_flesh_toml(generator, small_options());
    if (first.empty()) first = text;
    EXPECT_EQ(text, first);
  });
}

}  // namespace
}  // namespace vesalius::synth
