#include "commands/evaluate/truth_recipe.h"

#include <gmock/gmock.h>

#include "dataset/labelled_truth.h"
#include "synth/body/makehuman.h"
#include "synth/body/poser.h"

namespace vesalius::cli {
namespace {

/// The skeleton's joints tell the stature of a body in any pose, to a few centimetres.
TEST(TruthRecipe, KnowsTheStatureOfABody) {
  for (std::uint64_t i = 0; i < 12; ++i) {
    Random random(i);
    const auto mesh = std::make_shared<const synth::BodyMesh>(
        synth::make_body(synth::builtin_bodies(), synth::sample_factors({}, random), paper_body()));
    const synth::Poser poser(mesh, paper_body());
    synth::Pose pose;
    pose[synth::Bone::l_thigh] = Eigen::AngleAxisf(1.2F, Eigen::Vector3f::UnitX());
    LabelledFrame labelled;
    labelled.joints = {synth::joint_points(poser.pose(pose), Eigen::Isometry3f::Identity())};
    const FrameTruth truth = as_true_frame(labelled, synth::joint_names()).truth;
    ASSERT_EQ(truth.statures_m.size(), 1U);
    EXPECT_NEAR(truth.statures_m[0], mesh->stature_m, 0.04F);
  }
}

}  // namespace
}  // namespace vesalius::cli
