#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

/// The share of a part's volume that moves with one rig bone. The shares of a part sum to 1.
struct PartShare {
  int part = 0;
  int bone = 0;
  float share = 0.F;                                 ///< may be negative if the part's surface folds over itself
  Eigen::Vector3f moment = Eigen::Vector3f::Zero();  ///< share multiplied by its centre at rest, metres
};
/// Returns the shares of all parts of the body's own surface, by part and bone. A part's surface is closed at its rims
/// by flat fans.
std::vector<PartShare> part_shares(const BodyMesh& mesh, int part_count);

/// A body in a pose. The origin of the body frame lies under the pelvis, and the person's lowest vertex has y = 0.
/// Things that belong to nobody, such as a bag, may be lower.
struct PosedBody {
  std::vector<Eigen::Vector3f> vertices;             ///< in the order of the mesh's
  std::vector<Eigen::Vector3f> parts;                ///< centre of each part's volume; NaN if the body lacks the part
  std::array<Eigen::Vector3f, kBoneCount> joints{};  ///< head of each bone of `Pose`
  std::array<Eigen::Vector3f, kBoneCount> ends{};    ///< tail of each bone of `Pose`
};

/// Poses one body by linear blend skinning. Everything that depends only on the mesh is computed once.
class Poser {
 public:
  /// Throws Error as check() does for an invalid mesh.
  Poser(std::shared_ptr<const BodyMesh> mesh, const BodyModel& body);
  /// Returns the body in a pose. It may be called from several threads. Throws Error if a number of the pose is not
  /// finite.
  PosedBody pose(const Pose& pose) const;
  const BodyMesh& mesh() const { return *mesh_; }

 private:
  std::shared_ptr<const BodyMesh> mesh_;
  int part_count_ = 0;
  std::vector<PartShare> shares_;
  std::vector<std::uint8_t> grounded_;  ///< for each vertex 1 if it belongs to the person, 0 if to a carried thing
};

/// Returns the names of the joints in the truth of frames: the heads of the 19 bones of `Pose` under the bones' names
/// ("l_forearm" is the elbow), then five free ends: head_end, l_hand_end, r_hand_end, l_foot_end, r_foot_end.
const std::vector<std::string>& joint_names();

/// Returns these joints of a posed body in metres in the camera's frame.
std::vector<Eigen::Vector3f> joint_points(const PosedBody& body, const Eigen::Isometry3f& camera_from_body);

}  // namespace vesalius::synth
