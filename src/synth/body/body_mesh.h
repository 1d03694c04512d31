#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "synth/pose/pose.h"
#include "vesalius/base/body_model.h"

namespace vesalius::synth {

using Triangle = std::array<std::uint32_t, 3>;

/// What a triangle is made of; a person's look gives each a colour and texture.
enum class Fabric : std::uint8_t { skin, hair, top, bottom, shoes, accessory };
inline constexpr int kFabricCount = 6;

/// Which hand's grip curls a bone.
enum class Grip : std::uint8_t { none, left, right };

/// Bone of a body's own rig, in the body's rest pose.
struct RigBone {
  std::string name;
  int parent = -1;                                 ///< -1 for the root; parents come first
  Eigen::Vector3f head = Eigen::Vector3f::Zero();  ///< metres, body frame, in the body's own rest pose
  Eigen::Vector3f tail = Eigen::Vector3f::Zero();
  Bone from = Bone::pelvis;  ///< its rotation is slerp(world[from], world[to], blend) of the pose
  Bone to = Bone::pelvis;
  float blend = 0.F;
  bool hangs = false;       ///< stays upright whatever its parent does, and takes the heading alone from `from`
  bool twist_only = false;  ///< blend the turn about `from`'s own axis alone: a forearm follows the hand's twist
  /// pose-rest_from_body-rest: turns the bone from the body's own rest pose into the T of `Pose`.
  Eigen::Quaternionf t_from_rest = Eigen::Quaternionf::Identity();
  Grip grip = Grip::none;
  Eigen::Vector3f curl_axis = Eigen::Vector3f::Zero();  ///< body frame at rest, unit; fingers only
  float curl_rad = 0.F;                                 ///< angle at grip 1, about curl_axis, beside its parent's
};

/// Up to four bones move a vertex; weights sum to 1.
struct SkinWeights {
  std::array<std::uint16_t, 4> bone{};
  std::array<float, 4> weight{};
};

/// What bodies of one kind share: surface, labels, skinning.
struct BodyTopology {
  std::vector<Triangle> triangles;  ///< counter-clockwise seen from outside
  std::vector<std::uint8_t> part;   ///< per triangle: index in the body model; kBackground: belongs to nobody (a bag)
  std::vector<Fabric> fabric;       ///< per triangle
  std::vector<SkinWeights> skin;    ///< per vertex
  /// The first so many triangles are the body's own surface; what follows was added by dress().
  std::size_t body_triangles = 0;
};

/// A person at rest, ready to be posed: metres, x to the person's left, y up, z to the front.
struct BodyMesh {
  std::shared_ptr<const BodyTopology> topology;
  std::vector<Eigen::Vector3f> vertices;
  std::vector<RigBone> rig;
  std::array<int, kBoneCount> rig_of{};  ///< rig bone whose head is the joint of each bone of `Pose`
  float stature_m = 0.F;
};

/// Returns the bone whose head is this one's tail; heads, hands and feet return themselves.
Bone next_bone(Bone bone);

/// Ends of a bone of `Pose` in the body's own rest pose: its head, and the head of the bone that goes on from there
/// (the tail of its rig bone for heads, hands and feet).
struct BoneSegment {
  Eigen::Vector3f head = Eigen::Vector3f::Zero();
  Eigen::Vector3f tail = Eigen::Vector3f::Zero();
};
std::array<BoneSegment, kBoneCount> rest_bones(const BodyMesh& mesh);

/// Returns the mesh and its labels seen in a mirror (x -> -x).
BodyMesh mirrored(const BodyMesh& mesh, const BodyModel& body);

}  // namespace vesalius::synth
