#pragma once

#include <string>

#include "evaluation/evaluation.h"
#include "report/document.h"

namespace vesalius {

/// Adds the table of a set's ablation to a document. For each variant it has the most telling metrics, their difference
/// to the unchanged method with its interval, and the time per frame. Adds nothing if there was no ablation.
void add_ablation(const SetResult& set, Document& document);

/// Returns a line for each variant, for a terminal; empty without ablation.
std::string ablation_lines(const SetResult& set);

}  // namespace vesalius
