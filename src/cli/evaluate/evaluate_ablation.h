#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/evaluate/evaluate_set.h"
#include "report/document.h"

namespace vesalius::cli {

/// The table of a set's ablation: for each variant the figures that say most, their difference to the method as it was
/// asked for with its interval (docs/metrics.md), and the time a frame. Nothing where there was none.
void add_ablation(const SetResult& set, Document& document);

/// A line for each variant, for standard output; empty without ablation.
std::string ablation_lines(const SetResult& set);

/// A line for each set, variant and figure, all figures of them; the method as it was asked for is the variant "".
std::string ablation_csv(const std::vector<SetResult>& sets);

/// The same of one set: a list of variants, without that one.
nlohmann::ordered_json ablation_json(const SetResult& set);

}  // namespace vesalius::cli
