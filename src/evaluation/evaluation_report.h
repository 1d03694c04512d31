#pragma once

#include <string>

#include "evaluation/evaluation.h"

namespace vesalius {

/// Makes `folder` if it is missing. Throws Error where it cannot, or where plots cannot be made: an evaluation takes
/// long, and that should not turn out at its end.
void prepare_report(const std::string& folder);

/// Writes report.html, report.md with its pictures, report.json, figures.csv and, after an ablation, ablation.csv into
/// a folder that was prepared. Throws Error with the path that cannot be written.
void write_report(const Evaluation& evaluation, const std::string& folder);

}  // namespace vesalius
