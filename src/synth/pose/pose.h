#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string_view>

namespace vesalius::synth {

/// Bones of the skeleton that poses are written for; every body's rig and every motion file is mapped to it.
/// A parent comes before its children. Left and right are the person's own.
enum class Bone : std::uint8_t {
  pelvis,  ///< root: carries the whole body's orientation
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

/// "pelvis", "l_upper_arm", ...
std::string_view bone_name(Bone bone);
/// Index of the bone of that name, -1 where there is none.
int find_bone(std::string_view name);
/// The bone that `bone` hangs from; the pelvis is its own parent.
Bone parent(Bone bone);
/// Returns the same bone on the other side; a bone on the middle line returns itself.
Bone mirror(Bone bone);
/// Unit direction of the bone in the rest pose, body frame: a T: spine up, arms along +-x, palms down, legs down,
/// feet forward.
Eigen::Vector3f rest_direction(Bone bone);

/// Bones as an index.
constexpr int index(Bone bone) { return static_cast<int>(bone); }

/// Joint angles, free of the body's size. Body frame: x to the person's left, y up, z to the front; in the rest pose
/// (every rotation the identity) the person stands as a T.
struct Pose {
  /// parent_from_bone: turns the bone out of its rest direction, in the frame of its parent; for the pelvis the frame
  /// is the body's, whose yaw (heading) is free.
  std::array<Eigen::Quaternionf, kBoneCount> local;
  float l_grip = 0.2F;  ///< fingers: 0 stretched, 1 a fist
  float r_grip = 0.2F;

  Pose() { local.fill(Eigen::Quaternionf::Identity()); }
  Eigen::Quaternionf& operator[](Bone bone) { return local[index(bone)]; }
  const Eigen::Quaternionf& operator[](Bone bone) const { return local[index(bone)]; }
};

/// body_from_bone of every bone: products of `local` from the pelvis outwards.
std::array<Eigen::Quaternionf, kBoneCount> world_rotations(const Pose& pose);

/// The pose that gives these body_from_bone rotations.
Pose from_world_rotations(const std::array<Eigen::Quaternionf, kBoneCount>& world);

/// The pose seen in a mirror (x -> -x), left and right limbs swapped.
Pose mirrored(const Pose& pose);

/// The rotation with its turn about the vertical (y) taken off: what is left of a pelvis when heading does not count.
Eigen::Quaternionf without_yaw(const Eigen::Quaternionf& rotation);

/// Largest angle between two poses over all bones' local rotations, radians (section 4.1.2); the pelvis counts
/// without its yaw.
float largest_angle(const Pose& a, const Pose& b);

/// How a person is held up, which decides what a scene puts under it.
enum class Posture : std::uint8_t { standing, sitting, lying, kneeling };
std::string_view to_string(Posture posture);

}  // namespace vesalius::synth
