#pragma once

#include <string>
#include <string_view>

#include "vesalius/forest/boosted_trees.h"

namespace vesalius {

/// Reads trees that name the features they ask for; `source` is named in errors. Throws Error naming the line.
BoostedTrees parse_boosted_trees(std::string_view toml, const std::string& source);

/// Returns the same trees as parse_boosted_trees reads.
std::string to_toml(const BoostedTrees& trees);

/// Returns the judge of forests that have none, for any body, with and without a background class
/// (data/models/default_judge.toml and default_judge_alone.toml). Cut-out furniture looks like a body to the latter, so
/// other evidence matters.
const BoostedTrees& default_judge(bool background);

}  // namespace vesalius
