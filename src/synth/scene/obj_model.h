#pragma once

#include "synth/scene/model_mesh.h"

namespace vesalius::synth {

/// Reads a Wavefront OBJ model: `v`, `f` of 3 to 128 corners, `usemtl` and `mtllib` with the `Kd` of its materials; all
/// else is passed over. A material file that is not there leaves the model grey. Throws Error naming file and line for
/// what cannot be used.
void read_obj_model(ModelFiles& files, ModelMesh& mesh);

}  // namespace vesalius::synth
