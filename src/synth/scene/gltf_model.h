#pragma once

#include "synth/scene/model_mesh.h"

namespace vesalius::synth {

/// Reads the scene of a glTF 2.0 model, as JSON (.gltf) or with its buffer behind it (.glb): nodes with their
/// transforms, triangles, strips and fans with positions as floats, and the base colours of materials. Textures,
/// animations, skins and cameras are passed over. Throws Error naming the file and the place in it for what cannot be
/// used: buffers that end too early, sparse or compressed positions, indices out of range, nodes that are no tree.
void read_gltf_model(ModelFiles& files, ModelMesh& mesh);

}  // namespace vesalius::synth
