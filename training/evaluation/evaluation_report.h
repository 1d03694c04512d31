#pragma once

#include <string>

#include "evaluation/evaluation.h"

namespace vesalius {

/// Writes report.html, report.json and figures.csv into a folder (make_report_folder). Throws Error with the path that
/// cannot be written.
void write_report(const Evaluation& evaluation, const std::string& folder);

}  // namespace vesalius
