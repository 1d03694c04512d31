#pragma once

#include <string>

#include "evaluation/evaluation.h"
#include "report/document.h"

namespace vesalius {

/// Adds the table of a set's ablation to a document. For each variant it has the metrics that say most, their
/// difference to the method as it was asked for with its interval, and the time a frame. Adds nothing where there was
/// no ablation.
void add_ablation(const SetResult& set, Document& document);

/// Returns a line for each variant, for a terminal; empty without ablation.
std::string ablation_lines(const SetResult& set);

}  // namespace vesalius
