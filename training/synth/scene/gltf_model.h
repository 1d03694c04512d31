#pragma once

#include "synth/scene/model_mesh.h"

namespace vesalius::synth {

/// Reads the scene of a glTF 2.0 model in JSON (.gltf) or with its binary buffer (.glb). It reads nodes with their
/// transforms, triangles, strips and fans with positions as floats, and the base colours of materials. Textures,
/// animations, skins and cameras are ignored. Throws Error naming the file and the place in it for unusable content:
/// buffers that end too early, sparse or compressed positions, indices out of range, nodes that do not form a tree.
void read_gltf_model(ModelFiles& files, ModelMesh& mesh);

}  // namespace vesalius::synth
