#include "dataset/labelled_truth.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace vesalius {
namespace {

using Eigen::Vector3f;

struct NamedPoint {
  const char* name;
  Vector3f at;
};

/// The joints of somebody 1.7 m tall, upright, in the optical frame (y down), feet at y = 1.
const std::vector<NamedPoint> kStanding{{"pelvis", {0, 0.05F, 2}},
                                        {"spine", {0, 0, 2}},
                                        {"chest", {0, -0.2F, 2}},
                                        {"neck", {0, -0.45F, 2}},
                                        {"head", {0, -0.55F, 2}},
                                        {"head_end", {0, -0.73F, 2}},
                                        {"l_clavicle", {0.05F, -0.4F, 2}},
                                        {"r_clavicle", {-0.05F, -0.4F, 2}},
                                        {"l_upper_arm", {0.2F, -0.4F, 2}},
                                        {"r_upper_arm", {-0.2F, -0.4F, 2}},
                                        {"l_forearm", {0.2F, -0.1F, 2}},
                                        {"r_forearm", {-0.2F, -0.1F, 2}},
                                        {"l_hand", {0.2F, 0.15F, 2}},
                                        {"r_hand", {-0.2F, 0.15F, 2}},
                                        {"l_hand_end", {0.2F, 0.35F, 2}},
                                        {"r_hand_end", {-0.2F, 0.35F, 2}},
                                        {"l_thigh", {0.1F, 0.1F, 2}},
                                        {"r_thigh", {-0.1F, 0.1F, 2}},
                                        {"l_shin", {0.1F, 0.5F, 2}},
                                        {"r_shin", {-0.1F, 0.5F, 2}},
                                        {"l_foot", {0.1F, 0.92F, 2}},
                                        {"r_foot", {-0.1F, 0.92F, 2}},
                                        {"l_foot_end", {0.1F, 0.98F, 1.8F}},
                                        {"r_foot_end", {-0.1F, 0.98F, 1.8F}}};

FrameTruth truth_of(const std::vector<NamedPoint>& skeleton) {
  std::vector<std::string> names;
  std::vector<Vector3f> points;
  for (const NamedPoint& joint : skeleton) {
    names.emplace_back(joint.name);
    points.push_back(joint.at);
  }
  LabelledFrame labelled;
  labelled.joints = {points};
  return as_true_frame(labelled, names).truth;
}

Vector3f joint(const FrameTruth& truth, const std::string& name) {
  return truth.joints.at(0).at(std::ranges::find(truth.joint_names, name) - truth.joint_names.begin());
}

TEST(SkeletonTruth, NamesJointsAsTrackersDo) {
  const FrameTruth truth = truth_of(kStanding);
  EXPECT_EQ(joint(truth, "l_elbow"), Vector3f(0.2F, -0.1F, 2));
  EXPECT_EQ(joint(truth, "r_shoulder"), Vector3f(-0.2F, -0.4F, 2));
  EXPECT_LT((joint(truth, "head") - Vector3f(0, -0.64F, 2)).norm(), 1e-6F);
  EXPECT_LT((joint(truth, "l_hand") - Vector3f(0.2F, 0.25F, 2)).norm(), 1e-6F);
  EXPECT_LT((joint(truth, "hip_center") - Vector3f(0, 0.1F, 2)).norm(), 1e-6F);
}

TEST(SkeletonTruth, MeasuresStatureWhateverThePose) {
  EXPECT_NEAR(truth_of(kStanding).statures_m.at(0), 1.7F, 0.06F);
  std::vector<NamedPoint> sitting = kStanding;
  for (NamedPoint& joint : sitting) {  // thighs forward, shins down
    const std::string name = joint.name;
    if (name.ends_with("shin")) joint.at += Vector3f(0, -0.4F, -0.4F);
    if (name.ends_with("_foot") || name.ends_with("_foot_end")) joint.at += Vector3f(0, -0.4F, -0.4F);
  }
  EXPECT_FLOAT_EQ(truth_of(sitting).statures_m.at(0), truth_of(kStanding).statures_m.at(0));
}

TEST(SkeletonTruth, LeavesOutOtherSkeletons) {
  const FrameTruth truth = truth_of({{"hip", Vector3f::Zero()}, {"knee", Vector3f::Zero()}});
  EXPECT_TRUE(truth.joints.empty());
  EXPECT_TRUE(truth.joint_names.empty());
  EXPECT_TRUE(truth.statures_m.empty());
}

}  // namespace
}  // namespace vesalius
