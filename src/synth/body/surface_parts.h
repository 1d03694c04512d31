#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "synth/body/body_mesh.h"
#include "vesalius/base/body_model.h"

namespace vesalius::synth {

/// The surface rules of a body model by bone, side and place along the bone.
class SurfaceParts {
 public:
  /// Throws Error where the model has no rules, names a bone that does not exist, or leaves a stretch of a bone without
  /// a part.
  explicit SurfaceParts(const BodyModel& body);

  /// Returns the part of the surface `along` the bone: 0 at its head, 1 at its tail, clamped to these.
  std::uint8_t part(Bone bone, float along, bool left) const;

 private:
  struct Stretch {
    float to;
    std::uint8_t part;
  };
  std::array<std::array<std::vector<Stretch>, 2>, kBoneCount> stretches_;  ///< [bone][left], rising
};

/// Returns the part of every triangle of a body at rest: the rule of the bone that its corners' weights favour (on a
/// tie, one of its own side), at the place of its centre along that bone. Mirrored surfaces get mirrored parts to the
/// triangle.
std::vector<std::uint8_t> surface_parts(const BodyMesh& mesh, const SurfaceParts& rules);

/// Returns the bone of the pose that most moves each triangle, as surface_parts() finds it.
std::vector<Bone> surface_bones(const BodyMesh& mesh);

}  // namespace vesalius::synth
