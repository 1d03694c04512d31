#include "synth/pose/pose.h"

#include <algorithm>
#include <cmath>

namespace vesalius::synth {
namespace {

struct BoneInfo {
  std::string_view name;
  Bone parent;
  Bone mirror;
  std::array<float, 3> rest;
};

constexpr std::array<BoneInfo, kBoneCount> kBones{{
    {"pelvis", Bone::pelvis, Bone::pelvis, {0.F, 1.F, 0.F}},
    {"spine", Bone::pelvis, Bone::spine, {0.F, 1.F, 0.F}},
    {"chest", Bone::spine, Bone::chest, {0.F, 1.F, 0.F}},
    {"neck", Bone::chest, Bone::neck, {0.F, 1.F, 0.F}},
    {"head", Bone::neck, Bone::head, {0.F, 1.F, 0.F}},
    {"l_clavicle", Bone::chest, Bone::r_clavicle, {1.F, 0.F, 0.F}},
    {"l_upper_arm", Bone::l_clavicle, Bone::r_upper_arm, {1.F, 0.F, 0.F}},
    {"l_forearm", Bone::l_upper_arm, Bone::r_forearm, {1.F, 0.F, 0.F}},
    {"l_hand", Bone::l_forearm, Bone::r_hand, {1.F, 0.F, 0.F}},
    {"r_clavicle", Bone::chest, Bone::l_clavicle, {-1.F, 0.F, 0.F}},
    {"r_upper_arm", Bone::r_clavicle, Bone::l_upper_arm, {-1.F, 0.F, 0.F}},
    {"r_forearm", Bone::r_upper_arm, Bone::l_forearm, {-1.F, 0.F, 0.F}},
    {"r_hand", Bone::r_forearm, Bone::l_hand, {-1.F, 0.F, 0.F}},
    {"l_thigh", Bone::pelvis, Bone::r_thigh, {0.F, -1.F, 0.F}},
    {"l_shin", Bone::l_thigh, Bone::r_shin, {0.F, -1.F, 0.F}},
    {"l_foot", Bone::l_shin, Bone::r_foot, {0.F, 0.F, 1.F}},
    {"r_thigh", Bone::pelvis, Bone::l_thigh, {0.F, -1.F, 0.F}},
    {"r_shin", Bone::r_thigh, Bone::l_shin, {0.F, -1.F, 0.F}},
    {"r_foot", Bone::r_shin, Bone::l_foot, {0.F, 0.F, 1.F}},
}};

const BoneInfo& info(Bone bone) { return kBones[index(bone)]; }

/// The proportions of a bone as shares of the stature.
struct Proportion {
  float length;
  std::array<float, 3> offset;  ///< from the head of its parent to its own, at rest
};

constexpr std::array<Proportion, kBoneCount> kProportions{{
    {0.060F, {0.F, 0.F, 0.F}},         // pelvis: from midway between the hips to the lumbar spine
    {0.110F, {0.F, 0.060F, -0.010F}},  // spine
    {0.120F, {0.F, 0.110F, 0.F}},      // chest: up to the neck
    {0.052F, {0.F, 0.120F, 0.F}},      // neck
    {0.130F, {0.F, 0.052F, 0.010F}},   // head
    {0.099F, {0.014F, 0.112F, 0.F}},   // clavicles: the joints are within the width of the shoulders
    {0.186F, {0.099F, 0.F, 0.F}},      // upper arms
    {0.146F, {0.186F, 0.F, 0.F}},      // forearms
    {0.108F, {0.146F, 0.F, 0.F}},      // hands
    {0.099F, {-0.014F, 0.112F, 0.F}},  //
    {0.186F, {-0.099F, 0.F, 0.F}},     //
    {0.146F, {-0.186F, 0.F, 0.F}},     //
    {0.108F, {-0.146F, 0.F, 0.F}},     //
    {0.245F, {0.055F, 0.F, 0.F}},      // thighs: the joints are within the width of the hips
    {0.246F, {0.F, -0.245F, 0.F}},     // shins
    {0.110F, {0.F, -0.246F, 0.F}},     // feet: in front of the ankle
    {0.245F, {-0.055F, 0.F, 0.F}},     //
    {0.246F, {0.F, -0.245F, 0.F}},     //
    {0.110F, {0.F, -0.246F, 0.F}},     //
}};

/// Returns the position of a bone's head at rest relative to the head of its parent, in metres.
Eigen::Vector3f rest_offset_m(Bone bone) {
  const auto& o = kProportions[index(bone)].offset;
  return Eigen::Vector3f(o[0], o[1], o[2]) * kStickStature_m;
}

}  // namespace

std::string_view bone_name(Bone bone) { return info(bone).name; }

int find_bone(std::string_view name) {
  const auto found = std::ranges::find(kBones, name, &BoneInfo::name);
  return found == kBones.end() ? -1 : int(found - kBones.begin());
}

Bone parent(Bone bone) { return info(bone).parent; }

Bone mirror(Bone bone) { return info(bone).mirror; }

Eigen::Vector3f rest_direction(Bone bone) {
  const auto& d = info(bone).rest;
  return {d[0], d[1], d[2]};
}

std::array<Eigen::Quaternionf, kBoneCount> world_rotations(const Pose& pose) {
  std::array<Eigen::Quaternionf, kBoneCount> world;
  world[0] = pose.local[0];
  for (std::size_t b = 1; b < kBoneCount; ++b) {
    world[b] = (world[index(kBones[b].parent)] * pose.local[b]).normalized();
  }
  return world;
}

Pose from_world_rotations(const std::array<Eigen::Quaternionf, kBoneCount>& world) {
  Pose pose;
  pose.local[0] = world[0].normalized();
  for (std::size_t b = 1; b < kBoneCount; ++b) {
    pose.local[b] = (world[index(kBones[b].parent)].conjugate() * world[b]).normalized();
  }
  return pose;
}

Pose mirrored(const Pose& pose) {
  Pose out;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const Eigen::Quaternionf& q = pose.local[index(kBones[b].mirror)];
    out.local[b] = {q.w(), q.x(), -q.y(),
                    -q.z()};  // an axis is a pseudo-vector, so the component along the mirror's normal keeps its sign
  }
  out.l_grip = pose.r_grip;
  out.r_grip = pose.l_grip;
  return out;
}

Eigen::Quaternionf without_yaw(const Eigen::Quaternionf& rotation) {
  const float norm = std::hypot(rotation.w(), rotation.y());
  if (norm < 1e-6F) return rotation;  // upside down, so there is no heading to remove
  const Eigen::Quaternionf yaw(rotation.w() / norm, 0.F, rotation.y() / norm, 0.F);
  return (yaw.conjugate() * rotation).normalized();
}

float largest_angle(const Pose& a, const Pose& b) {
  float largest = without_yaw(a[Bone::pelvis]).angularDistance(without_yaw(b[Bone::pelvis]));
  for (std::size_t i = 1; i < kBoneCount; ++i) largest = std::max(largest, a.local[i].angularDistance(b.local[i]));
  return largest;
}

std::string_view to_string(Posture posture) {
  switch (posture) {
    case Posture::standing:
      return "standing";
    case Posture::sitting:
      return "sitting";
    case Posture::lying:
      return "lying";
    case Posture::kneeling:
      return "kneeling";
  }
  return "standing";
}

float bone_length_m(Bone bone) { return kProportions[index(bone)].length * kStickStature_m; }

StickFigure stick_figure(const Pose& pose) {
  const auto world = world_rotations(pose);
  StickFigure out;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const auto bone = static_cast<Bone>(b);
    const auto up = static_cast<std::size_t>(parent(bone));
    out.head[b] = b == 0 ? Eigen::Vector3f::Zero().eval() : (out.head[up] + world[up] * rest_offset_m(bone)).eval();
    out.tail[b] = out.head[b] + world[b] * (rest_direction(bone) * bone_length_m(bone));
  }
  return out;
}

}  // namespace vesalius::synth
