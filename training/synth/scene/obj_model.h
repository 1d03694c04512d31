#pragma once

#include "synth/scene/model_mesh.h"

namespace vesalius::synth {

/// Reads a Wavefront OBJ model: `v`, `f` of 3 to 128 corners, `usemtl`, and `mtllib` with the `Kd` of its materials.
/// Everything else is ignored. If a material file is missing, the model is grey. Throws Error naming file and line for
/// unusable content.
void read_obj_model(ModelFiles& files, ModelMesh& mesh);

}  // namespace vesalius::synth
