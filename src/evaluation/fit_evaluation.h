#pragma once

#include <string>

#include "eval/fit_score.h"
#include "evaluation/evaluation.h"

namespace vesalius {

/// Returns as TOML the joint sets with which the sets' truth was compared. Their depth offsets are the medians over the
/// frames that were reserved for fitting. Throws Error if there was nothing to fit.
std::string fitted_joints_toml(const Evaluation& evaluation);

/// The detector options of an evaluation with the person score fitted to all its sets.
struct FittedOptions {
  DetectOptions options;
  ScoreFit fit;  ///< the fit, with weights not yet rounded to hundredths
};
/// Fits the score. Throws Error as fit_score does.
FittedOptions fit_score_options(const Evaluation& evaluation);

}  // namespace vesalius
