#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Version that this program writes and the newest it reads.
inline constexpr int kModelVersion = 2;

/// Reads a model file (docs/formats.md) of this version or an older one. Throws Error for a truncated, foreign, damaged
/// (checksum) or newer file. Trees are unpacked in parallel.
Forest load_model(const std::string& path);

/// The same from bytes; `name` stands for the path in errors.
Forest parse_model(std::string_view bytes, const std::string& name);

/// Writes beside `path`, then renames: no half-written model. Throws Error when it cannot.
void save_model(const Forest& forest, const std::string& path);

/// The bytes of a model file; the same forest gives the same bytes, by one version of zstd. About 8 bytes for a node
/// and a leaf of trees in depth-first order (model_trees.h). Throws Error for an inconsistent forest, for one of more
/// than kMaxModelNodes, and for a body whose text does not describe it.
std::string serialise_model(const Forest& forest);

/// Checksum over the bytes of a whole model file, 16 hexadecimal digits: names a model whatever its file is called.
std::string model_checksum(std::string_view bytes);

/// Reads the text trees of the paper's released code (first line height H, 2^H-1 lines "du1 dv1 du2 dv2 threshold" in
/// level order, 2^H labels; .bz2 accepted) as a forest of the paper body without background. Padding nodes and
/// branches whose leaves agree are pruned; every pixel still reaches a leaf of the same label.
Forest import_text_trees(const std::vector<std::string>& paths);

/// One such tree from its text; `name` stands for the path in errors.
Tree parse_text_tree(std::string_view text, const std::string& name);

}  // namespace vesalius
