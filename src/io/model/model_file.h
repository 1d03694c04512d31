#pragma once

#include <string>
#include <string_view>

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Version of the model files that this program writes and reads.
inline constexpr int kModelVersion = 2;

/// Reads a model file (docs/formats.md). Throws Error for a truncated, foreign or damaged (checksum) file and for one
/// of another version. Trees are unpacked in parallel.
Forest load_model(const std::string& path);

/// Reads the same from bytes; `name` stands for the path in errors.
Forest parse_model(std::string_view bytes, const std::string& name);

/// Writes a model file beside `path`, then renames it: no half-written model is ever seen. Throws Error when it cannot.
void save_model(const Forest& forest, const std::string& path);

/// Returns the bytes of a model file; the same forest gives the same bytes, by one version of zstd. About 8 bytes for a
/// node and a leaf of trees in depth-first order (model_trees.h). Throws Error for an inconsistent forest, for one of
/// more than kMaxModelNodes, and for a body whose text does not describe it.
std::string serialise_model(const Forest& forest);

/// Returns the checksum over the bytes of a whole model file, 16 hexadecimal digits, which names a model whatever its
/// file is called.
std::string model_checksum(std::string_view bytes);

}  // namespace vesalius
