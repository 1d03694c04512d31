#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "vesalius/forest.h"

namespace vesalius {

/// Reads the text trees of the paper's released code as a forest of the paper's body without a background class. The
/// first line of a file is the height H; then follow 2^H-1 lines "du1 dv1 du2 dv2 threshold" in level order and 2^H
/// labels. Files compressed as .bz2 are accepted. Padding nodes and branches whose leaves agree are removed; every
/// pixel still reaches a leaf of the same label. Throws Error naming the file if it is damaged.
Forest import_text_trees(const std::vector<std::string>& paths);

/// Reads one tree from its text; `name` is used as the path in errors.
Tree parse_text_tree(std::string_view text, const std::string& name);

}  // namespace vesalius
