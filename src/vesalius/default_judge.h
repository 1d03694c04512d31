#pragma once

#include <string>
#include <string_view>

#include "vesalius/boosted_trees.h"

namespace vesalius {

/// Reads trees that name the features they ask for; `source` is named in errors. Throws Error naming the line.
BoostedTrees parse_boosted_trees(std::string_view toml, const std::string& source);

/// Returns the same trees as parse_boosted_trees reads.
std::string to_toml(const BoostedTrees& trees);

/// Returns the judge of models that have none, for any body (data/models/default_judge.toml).
const BoostedTrees& default_judge();
/// Returns that of models that are shown cut-outs (cut_out_labeller.h; data/models/default_judge_alone.toml). Cut-out
/// furniture looks like a body to them, so other evidence matters.
const BoostedTrees& default_judge_of_cut_outs();

}  // namespace vesalius
