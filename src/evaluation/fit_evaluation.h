#pragma once

#include <string>

#include "eval/fit_score.h"
#include "evaluation/evaluation.h"

namespace vesalius {

/// Returns as TOML the joint sets that the sets' truth was compared with. Their depth offsets are the medians over the
/// frames that were left out for fitting. Throws Error where there was nothing to fit.
std::string fitted_joints_toml(const Evaluation& evaluation);

/// The detector options of an evaluation with the person score fitted to all its sets.
struct FittedOptions {
  DetectOptions options;
  ScoreFit fit;  ///< with weights before they were rounded to hundredths
};
/// Throws Error as fit_score does.
FittedOptions fit_score_options(const Evaluation& evaluation);

}  // namespace vesalius
