#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/part_shares.h"

namespace vesalius::synth {

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

}  // namespace vesalius::synth
