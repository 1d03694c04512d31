#pragma once

#include <string>

#include "evaluation/evaluation.h"

namespace vesalius {

/// Creates `folder` if it is missing. Throws Error if it cannot, or if plots cannot be made. It is called before the
/// evaluation, so that a long run does not fail at its end.
void prepare_report(const std::string& folder);

/// Writes report.html, report.md with its pictures, report.json and figures.csv into
/// a folder that was prepared. Throws Error with the path that cannot be written.
void write_report(const Evaluation& evaluation, const std::string& folder);

}  // namespace vesalius
