#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "synth/pose/pose.h"
#include "vesalius/body_model.h"

namespace vesalius::synth {

using Triangle = std::array<std::uint32_t, 3>;

/// The material of a triangle. A person's look gives each fabric a colour and texture.
enum class Fabric : std::uint8_t { skin, hair, top, bottom, shoes, accessory };
inline constexpr int kFabricCount = 6;

/// The hand whose grip curls a bone.
enum class Grip : std::uint8_t { none, left, right };

/// A bone of a body's own rig, in the body's rest pose.
struct RigBone {
  std::string name;
  int parent = -1;                                 ///< -1 for the root; parents come first
  Eigen::Vector3f head = Eigen::Vector3f::Zero();  ///< metres, body frame, in the body's own rest pose
  Eigen::Vector3f tail = Eigen::Vector3f::Zero();
  Bone from = Bone::pelvis;  ///< its rotation is slerp(world[from], world[to], blend) of the pose
  Bone to = Bone::pelvis;
  float blend = 0.F;
  bool hangs = false;       ///< stays upright whatever its parent does; takes only the heading from `from`
  bool twist_only = false;  ///< blends only the turn about `from`'s own axis, as a forearm follows the hand's twist
  /// This rotation turns the bone from the body's own rest pose into the T of `Pose`.
  Eigen::Quaternionf t_from_rest = Eigen::Quaternionf::Identity();
  Grip grip = Grip::none;
  Eigen::Vector3f curl_axis = Eigen::Vector3f::Zero();  ///< unit vector in the body frame at rest; for fingers only
  float curl_rad = 0.F;  ///< angle about curl_axis at grip 1, in addition to its parent's
};

/// The weights of the up to four bones that move a vertex. They sum to 1.
struct SkinWeights {
  std::array<std::uint16_t, 4> bone{};
  std::array<float, 4> weight{};
};

/// The data that bodies of one kind share: surface, labels and skinning.
struct BodyTopology {
  std::vector<Triangle> triangles;  ///< counter-clockwise when seen from outside
  /// For each triangle the index of its part in the body model, or kBackground if it belongs to nobody (a bag).
  std::vector<std::uint8_t> part;
  std::vector<Fabric> fabric;     ///< per triangle
  std::vector<SkinWeights> skin;  ///< per vertex
  /// The number of triangles of the body's own surface. They come first; later ones were added by dress().
  std::size_t body_triangles = 0;
};

/// A person at rest, ready to be posed, in metres: x to the person's left, y up, z to the front.
struct BodyMesh {
  std::shared_ptr<const BodyTopology> topology;
  std::vector<Eigen::Vector3f> vertices;
  std::vector<RigBone> rig;
  std::array<int, kBoneCount> rig_of{};  ///< for each bone of `Pose`, the rig bone whose head is its joint
  float stature_m = 0.F;
};

/// Returns the bone that begins where this one ends. Heads, hands and feet return themselves.
Bone next_bone(Bone bone);

/// The ends of a bone of `Pose` in the body's own rest pose: its head, and the head of the bone that follows it. For
/// heads, hands and feet the second end is the tail of the rig bone.
struct BoneSegment {
  Eigen::Vector3f head = Eigen::Vector3f::Zero();
  Eigen::Vector3f tail = Eigen::Vector3f::Zero();
};
std::array<BoneSegment, kBoneCount> rest_bones(const BodyMesh& mesh);

/// Throws Error naming the fault if a body has an index out of range, weights that do not sum to 1, or a number that is
/// not finite.
void check(const BodyMesh& mesh, const BodyModel& body);

}  // namespace vesalius::synth
