#pragma once

#include <array>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/builtin_measures.h"
#include "synth/body/builtin_shape.h"
#include "synth/body/limb.h"

namespace vesalius::synth {

/// The skeleton and flesh of the built-in body: standing, arms 45 degrees down, palms facing the thighs. Metres.
struct BuiltinFigure {
  std::array<BoneSegment, kBuiltinBoneCount> bones;  ///< of the built-in rig
  std::vector<Limb> limbs;                           ///< paired ones: the left
};
BuiltinFigure builtin_figure(const BuiltinShape& shape);

}  // namespace vesalius::synth
