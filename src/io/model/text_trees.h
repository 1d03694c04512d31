#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Reads the text trees of the paper's released code (first line height H, 2^H-1 lines "du1 dv1 du2 dv2 threshold" in
/// level order, 2^H labels; .bz2 accepted) as a forest of the paper body without background. Padding nodes and
/// branches whose leaves agree are pruned; every pixel still reaches a leaf of the same label. Throws Error naming the
/// file for one that is damaged.
Forest import_text_trees(const std::vector<std::string>& paths);

/// Reads one such tree from its text; `name` stands for the path in errors.
Tree parse_text_tree(std::string_view text, const std::string& name);

}  // namespace vesalius
