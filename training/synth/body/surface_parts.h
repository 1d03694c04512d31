#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "synth/body/body_mesh.h"
#include "vesalius/body_model.h"

namespace vesalius::synth {

/// The surface rules of a body model by bone, side and position along the bone.
class SurfaceParts {
 public:
  /// Throws Error if the model has no rules, names an unknown bone, or leaves a stretch of a bone without a part.
  explicit SurfaceParts(const BodyModel& body);

  /// Returns the part of the surface at the position `along` of the bone: 0 is its head, 1 its tail; other values are
  /// clamped.
  std::uint8_t part(Bone bone, float along, bool left) const;

 private:
  struct Stretch {
    float to;
    std::uint8_t part;
  };
  std::array<std::array<std::vector<Stretch>, 2>, kBoneCount> stretches_;  ///< [bone][left], in rising order
};

/// Returns the part of every triangle of a body at rest. It is given by the rule of the bone with the largest weights
/// at the triangle's corners (on a tie, a bone of its own side), at the position of its centre along that bone.
/// Mirrored surfaces get exactly mirrored parts.
std::vector<std::uint8_t> surface_parts(const BodyMesh& mesh, const SurfaceParts& rules);

/// Returns for each triangle the bone of the pose that moves it most, as surface_parts() finds it.
std::vector<Bone> surface_bones(const BodyMesh& mesh);

}  // namespace vesalius::synth
