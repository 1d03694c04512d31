#pragma once

#include <string>
#include <string_view>

#include "vesalius/model.h"

namespace vesalius {

/// Reads a model file (docs/formats.md). Throws Error if the file is no model or of another version, and names the
/// section that is missing, truncated, damaged (by its checksum), there twice, or not known to this version. Trees are
/// unpacked in parallel.
Model load_model(const std::string& path);

/// Reads a model from bytes; `name` is used as the path in errors.
Model parse_model(std::string_view bytes, const std::string& name);

/// Writes a model file atomically, so a half-written model is never seen. Throws Error if it cannot be written.
void save_model(const Model& model, const std::string& path);

/// Returns the bytes of a model file. One version of zstd always gives the same bytes for the same model. A node and a
/// leaf take about 8 bytes together if the trees are in depth-first order (model_trees.h). Throws Error for an
/// inconsistent model, for one whose forest a labeller has replaced, for more than kMaxModelNodes nodes or leaves, and
/// for a body whose text does not describe it.
std::string serialise_model(const Model& model);

/// Returns the checksum of a whole model file as 16 hexadecimal digits. It identifies a model whatever its file is
/// called.
std::string model_checksum(std::string_view bytes);

}  // namespace vesalius
