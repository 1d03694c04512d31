#pragma once

#include <string>

#include "synth/scene/scene.h"
#include "synth/text/read_text.h"

namespace vesalius::synth {

/// Options for reading a user's model, and its limits. The result is in metres with y up.
struct ImportOptions {
  float metres_per_unit = 1.F;
  bool z_up = false;  ///< whether the file's z axis points up instead of y
  int max_triangles = 200'000;
};

/// Reads an OBJ, glTF or GLB model through `read`, with its materials and buffers, whose paths are relative to the
/// model's folder and must not leave it. The result has triangles in plain colours and stands on y = 0 about the
/// origin. Throws Error naming the file if it cannot be read, has no surface, has more triangles than allowed or
/// numbers that are not finite, or is not between 1 cm and 20 m in size.
SceneMesh import_model(const std::string& path, const ReadText& read, const ImportOptions& options = {});

}  // namespace vesalius::synth
