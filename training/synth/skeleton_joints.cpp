#include "synth/skeleton_joints.h"

#include <array>

namespace vesalius::synth {
namespace {

constexpr std::array kFreeEnds = {Bone::head, Bone::l_hand, Bone::r_hand, Bone::l_foot, Bone::r_foot};

}  // namespace

const std::vector<std::string>& joint_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (int b = 0; b < kBoneCount; ++b) all.emplace_back(bone_name(static_cast<Bone>(b)));
    for (const Bone bone : kFreeEnds) all.push_back(std::string(bone_name(bone)) + "_end");
    return all;
  }();
  return names;
}

std::vector<Eigen::Vector3f> joint_points(const PosedBody& body, const Eigen::Isometry3f& camera_from_body) {
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3f& p : body.joints) points.emplace_back(camera_from_body * p);
  for (const Bone bone : kFreeEnds) points.emplace_back(camera_from_body * body.ends[index(bone)]);
  return points;
}

}  // namespace vesalius::synth
