#pragma once

#include <array>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/builtin_measures.h"
#include "synth/body/builtin_shape.h"
#include "synth/body/limb.h"

namespace vesalius::synth {

/// The skeleton and flesh of the built-in body, in metres. It stands with its arms 45 degrees down and its palms facing
/// the thighs.
struct BuiltinFigure {
  std::array<BoneSegment, kBuiltinBoneCount> bones;  ///< bones of the built-in rig
  std::vector<Limb> limbs;                           ///< of paired limbs only the left one
};
BuiltinFigure builtin_figure(const BuiltinShape& shape);

}  // namespace vesalius::synth
