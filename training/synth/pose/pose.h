#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string_view>

namespace vesalius::synth {

/// The bones of the skeleton that poses use. Every body's rig and every motion file is mapped to it. A parent comes
/// before its children. Left and right are the person's own.
enum class Bone : std::uint8_t {
  pelvis,  ///< the root, which carries the orientation of the whole body
  spine,   ///< lumbar
  chest,
  neck,
  head,
  l_clavicle,
  l_upper_arm,
  l_forearm,
  l_hand,
  r_clavicle,
  r_upper_arm,
  r_forearm,
  r_hand,
  l_thigh,
  l_shin,
  l_foot,
  r_thigh,
  r_shin,
  r_foot
};
inline constexpr int kBoneCount = 19;

/// Returns the bone's name: "pelvis", "l_upper_arm", ...
std::string_view bone_name(Bone bone);
/// Returns the index of the bone of that name, or -1 if there is none.
int find_bone(std::string_view name);
/// Returns the parent of a bone. The pelvis is its own parent.
Bone parent(Bone bone);
/// Returns the same bone on the other side; a bone on the middle line returns itself.
Bone mirror(Bone bone);
/// Returns the unit direction of the bone in the rest pose, in the body frame. The rest pose is a T: spine up, arms
/// along +-x with palms down, legs down, feet forward.
Eigen::Vector3f rest_direction(Bone bone);

/// Returns the bone as an index.
constexpr int index(Bone bone) { return int(bone); }

/// Joint rotations without the body's size. In the body frame x points to the person's left, y up and z to the front.
/// In the rest pose, where every rotation is the identity, the person stands as a T.
struct Pose {
  /// These are the rotations parent_from_bone. They turn a bone out of its rest direction in the frame of its parent.
  /// The pelvis is turned in the body frame, and its yaw (heading) is arbitrary.
  std::array<Eigen::Quaternionf, kBoneCount> local;
  float l_grip = 0.2F;  ///< 0 is a stretched hand, 1 a fist
  float r_grip = 0.2F;

  Pose() { local.fill(Eigen::Quaternionf::Identity()); }
  Eigen::Quaternionf& operator[](Bone bone) { return local[index(bone)]; }
  const Eigen::Quaternionf& operator[](Bone bone) const { return local[index(bone)]; }
};

/// Returns the rotation body_from_bone of every bone: the products of `local` from the pelvis outwards.
std::array<Eigen::Quaternionf, kBoneCount> world_rotations(const Pose& pose);

/// Returns the pose that has these body_from_bone rotations.
Pose from_world_rotations(const std::array<Eigen::Quaternionf, kBoneCount>& world);

/// Returns the mirror image of the pose (x -> -x) with left and right limbs swapped.
Pose mirrored(const Pose& pose);

/// Returns the rotation without its turn about the vertical (y), which is the heading of a pelvis.
Eigen::Quaternionf without_yaw(const Eigen::Quaternionf& rotation);

/// Returns the largest angle between two poses over all bones' local rotations in radians (section 4.1.2). The yaw of
/// the pelvis is ignored.
float largest_angle(const Pose& a, const Pose& b);

/// How a person is supported, which decides what a scene puts under them.
enum class Posture : std::uint8_t { standing, sitting, lying, kneeling };
std::string_view to_string(Posture posture);

/// The bones of a person of standard proportions in metres. The frame is the body frame, moved such that the point
/// midway between the hips is the origin.
struct StickFigure {
  std::array<Eigen::Vector3f, kBoneCount> head;  ///< joint about which the bone turns
  std::array<Eigen::Vector3f, kBoneCount> tail;

  const Eigen::Vector3f& head_of(Bone bone) const { return head[index(bone)]; }
  const Eigen::Vector3f& tail_of(Bone bone) const { return tail[index(bone)]; }
};

/// The stature of the standard person in metres.
inline constexpr float kStickStature_m = 1.72F;

/// Returns the length of a bone of the standard person in metres. Lengths are shares of the stature by Drillis and
/// Contini (1966), as printed in D. A. Winter, "Biomechanics and Motor Control of Human Movement", figure 4.1; the
/// trunk is divided at L3 and T10.
float bone_length_m(Bone bone);

StickFigure stick_figure(const Pose& pose);

}  // namespace vesalius::synth
