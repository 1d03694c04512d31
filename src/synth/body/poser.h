#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/part_shares.h"

namespace vesalius::synth {

/// A body in a pose. The body frame's origin lies under the pelvis, the person's lowest vertex at y = 0 (what belongs
/// to nobody, as a bag, may reach lower).
struct PosedBody {
  std::vector<Eigen::Vector3f> vertices;             ///< same order as the mesh's
  std::vector<Eigen::Vector3f> parts;                ///< centre of each part's volume; NaN where the body has none
  std::array<Eigen::Vector3f, kBoneCount> joints{};  ///< head of each bone of `Pose`
  std::array<Eigen::Vector3f, kBoneCount> ends{};    ///< tail of each bone of `Pose`
};

/// Poses bodies by linear blend skinning. What depends on the mesh only is worked out once.
class Poser {
 public:
  /// Throws Error as check() does for a mesh that is no body.
  Poser(std::shared_ptr<const BodyMesh> mesh, const BodyModel& body);
  /// Returns the body in a pose. It is safe to call from several threads. Throws Error for a pose with a number that is
  /// not finite.
  PosedBody pose(const Pose& pose) const;
  const BodyMesh& mesh() const { return *mesh_; }

 private:
  std::shared_ptr<const BodyMesh> mesh_;
  int part_count_ = 0;
  std::vector<PartShare> shares_;
  std::vector<std::uint8_t> grounded_;  ///< per vertex: 1 where it is the person's, not of a thing carried
};

}  // namespace vesalius::synth
