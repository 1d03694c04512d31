#include "nite2/users.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "vesalius/error.h"
#include "vesalius/fit/flesh_joints.h"

namespace vesalius::nite2 {
namespace {

constexpr std::array<const char*, NITE_JOINT_COUNT> kNames{"head",    "neck",   "l_shoulder", "r_shoulder", "l_elbow",
                                                           "r_elbow", "l_hand", "r_hand",     "torso",      "l_hip",
                                                           "r_hip",   "l_knee", "r_knee",     "l_foot",     "r_foot"};

/// The joint before each towards the torso.
constexpr std::array<int, NITE_JOINT_COUNT> kNext{1, 8, 1, 1, 2, 3, 4, 5, -1, 8, 8, 9, 10, 11, 12};
/// An order in which that comes first.
constexpr std::array<int, NITE_JOINT_COUNT> kOutwards{8, 1, 0, 2, 3, 4, 5, 6, 7, 9, 10, 11, 12, 13, 14};

/// Bones at rest stand in a T: x to the person's left, y up, z to the front. Before the camera that is so.
const Eigen::Quaternionf kBonesFromTee(0.F, 1.F, 0.F, 0.F);

}  // namespace

NiteJoints::NiteJoints(const BodyModel& body) : set_(find_joint_set(body, "nite15")) {
  const JointSet& set = body.joint_sets[set_];
  for (std::size_t j = 0; j < kNames.size(); ++j) {
    const auto joint = std::ranges::find(set.joints, kNames[j], &JointDefinition::name);
    if (joint == set.joints.end()) throw Error(std::string("the model's joint set nite15 has no ") + kNames[j]);
    index_[j] = static_cast<std::size_t>(joint - set.joints.begin());
    const FleshJoint* place = find_flesh_joint(builtin_flesh_joints(), set.name, kNames[j]);
    bone_[j] = place != nullptr ? place->bone : -1;
  }
}

Joints NiteJoints::ordered(const std::vector<Joint>& joints) const {
  Joints found;
  for (std::size_t j = 0; j < found.size(); ++j) found[j] = joints[index_[j]];
  return found;
}

std::array<std::optional<Eigen::Quaternionf>, NITE_JOINT_COUNT> NiteJoints::turns(const TrackedPerson& person) const {
  std::array<std::optional<Eigen::Quaternionf>, NITE_JOINT_COUNT> turns;
  if (!person.body) return turns;
  for (std::size_t j = 0; j < turns.size(); ++j) {
    if (bone_[j] < 0) continue;
    const FittedBone& bone = person.body->bones[static_cast<std::size_t>(bone_[j])];
    if (bone.state != State::none) turns[j] = bone.global * kBonesFromTee;
  }
  return turns;
}

NiteUserId user_id(int id) {
  constexpr int kMost = std::numeric_limits<NiteUserId>::max();
  return static_cast<NiteUserId>((id - 1) % kMost + 1);
}

NiteSkeleton skeleton_of(const TrackedPerson& person, const Joints& joints, const NiteJoints& set,
                         const DepthView& view) {
  const auto turns = set.turns(person);
  NiteSkeleton skeleton{};
  skeleton.state = NITE_SKELETON_TRACKED;
  for (const int j : kOutwards) {
    NiteSkeletonJoint& to = skeleton.joints[j];
    if (kNext[j] >= 0) {
      to = skeleton.joints[kNext[j]];
    } else {
      to.position = view.millimetres(person.position);
      to.orientation = {0.F, 0.F, 0.F, 1.F};
    }
    to.jointType = static_cast<NiteJointType>(j);
    to.positionConfidence = to.orientationConfidence = 0.F;
    const Joint& joint = joints[j];
    if (joint.state != State::none) {
      to.position = view.millimetres(joint.position);
      to.positionConfidence = joint.confidence;
    }
    if (turns[j]) {
      to.orientation = view.turn(*turns[j]);
      to.orientationConfidence = to.positionConfidence;
    }
  }
  return skeleton;
}

NitePoseData pose_of(NitePoseType type, bool detects, bool holds, bool& held) {
  NitePoseData pose{type, 0};
  if (detects) pose.state |= NITE_POSE_STATE_DETECTING;
  if (detects && holds) pose.state |= NITE_POSE_STATE_IN_POSE | (held ? 0 : NITE_POSE_STATE_ENTER);
  if (held && !(detects && holds)) pose.state |= NITE_POSE_STATE_EXIT;
  held = detects && holds;
  return pose;
}

NitePlane floor_of(const FloorView& floor, const DepthView& view) {
  return {view.millimetres(-floor.height_m * floor.up), view.direction(floor.up)};
}

std::vector<NiteUserId> user_map(const std::vector<Person>& people, const std::vector<NiteUserId>& ids,
                                 const Frame& frame, const DepthView& view) {
  const int width = frame.camera.width, height = frame.camera.height;
  const Image<std::uint8_t> indices = body_index_map(people, width, height);
  std::vector<NiteUserId> map(indices.size());
  for (int v = 0; v < height; ++v) {
    const std::uint8_t* row = indices.row(v);
    NiteUserId* to = map.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(width);
    for (int u = 0; u < width; ++u) {
      if (row[u] != kBackground) to[view.column(u, width)] = ids[row[u]];
    }
  }
  return map;
}

void place_user(const Person& person, const Frame& frame, const DepthView& view, NiteUserData& user) {
  if (person.mask.empty()) return;
  const int width = frame.camera.width;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Array3f least = Eigen::Array3f::Constant(std::numeric_limits<float>::max()), most = -least;
  long count = 0;
  for (int v = person.box.v; v < person.box.v + person.box.height; ++v) {
    for (int u = person.box.u; u < person.box.u + person.box.width; ++u) {
      if (person.mask(u, v) == 0) continue;
      if (frame.depth(u, v) == 0) continue;
      const Eigen::Array3f pixel(float(view.column(u, width)), float(v), float(frame.depth(u, v)));
      least = least.min(pixel);
      most = most.max(pixel);
      sum += point_at(frame.camera, frame.depth, u, v).cast<double>();
      ++count;
    }
  }
  if (count == 0) return;
  user.boundingBox = {{least.x(), least.y(), least.z()}, {most.x(), most.y(), most.z()}};
  user.centerOfMass = view.millimetres((sum / double(count)).cast<float>());
}

}  // namespace vesalius::nite2
