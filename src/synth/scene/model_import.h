#pragma once

#include <string>

#include "synth/scene/scene.h"
#include "synth/text/read_text.h"

namespace vesalius::synth {

/// What a file of the user's may hold, and how it becomes metres with y up.
struct ImportOptions {
  float metres_per_unit = 1.F;
  bool z_up = false;  ///< the file's z axis points up rather than y
  int max_triangles = 200'000;
};

/// Reads an OBJ, glTF or GLB model with all it refers to (materials, buffers; their paths are relative to the model's,
/// and must not leave its folder) through `read`. The result is triangles standing on y = 0 about the origin with
/// plain colours. Throws Error naming the file for one that cannot be read, has no surface, more triangles than
/// allowed, numbers that are not finite, or is not between 1 cm and 20 m in size.
SceneMesh import_model(const std::string& path, const ReadText& read, const ImportOptions& options = {});

}  // namespace vesalius::synth
