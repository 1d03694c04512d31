#pragma once

#include <string>
#include <vector>

#include "cli/evaluate/evaluate_set.h"
#include "vesalius/base/body_model.h"
#include "vesalius/detect.h"

namespace vesalius::cli {

/// Version of report.json that is written and the newest that is read.
inline constexpr int kEvaluationVersion = 1;

/// Steps of the curve over the score.
inline constexpr int kScoreSteps = 50;

/// One run of `vesalius evaluate`.
struct Evaluation {
  std::string command;  ///< that repeats it
  std::string model;    ///< path
  std::string model_checksum;
  DetectOptions options;
  BodyModel body;
  bool labels_only = false;
  bool has_background = false;  ///< the model has a background class
  std::vector<SetResult> sets;
};

/// What a figure is called in tables, and its value: "97.2 %", "0.041 m".
std::string figure_text(const Estimate& estimate);
/// The same with its interval: "97.2 % (95.1-98.4)".
std::string figure_with_interval(const Estimate& estimate);

/// A value of a figure of that name in its unit; `sign`: a difference, "+1.20 %".
std::string figure_number(const std::string& name, double value, bool sign);

/// Text as a field of a CSV line: commas become semicolons.
std::string csv_field(std::string text);

/// "12.3 frames/s", or where frames were timed one by one, "41.0 ms a frame".
std::string speed_text(const SetResult& set);

/// What a set came to, for standard output: one line, and one for each group of shares (parts, postures, joints).
std::string summary_lines(const SetResult& set);

/// report.json (docs/metrics.md): everything as numbers, what `vesalius compare` reads.
std::string evaluation_json(const Evaluation& evaluation);
/// One line for each figure of each set.
std::string evaluation_csv(const Evaluation& evaluation);

/// Makes `folder` if missing. Throws Error where it cannot, or where plots cannot be made: an evaluation takes long,
/// and that should not turn out at its end.
void prepare_report(const std::string& folder);

/// Writes report.html, report.md with its pictures, report.json and figures.csv into a folder that was prepared.
void write_report(const Evaluation& evaluation, const std::string& folder);

/// The joint sets that the sets' truth was compared with, with the depth offsets fitted on the frames left out of the
/// joints' figures (medians), as TOML. Throws Error where there was nothing to fit.
std::string fitted_joints_toml(const Evaluation& evaluation);

/// Writes the detector options of the evaluation, with the score fitted to all its sets (fit_score.h), as TOML, and
/// prints what that is worth. Throws Error as fit_score and write_options do.
void write_fitted_score(const Evaluation& evaluation, const std::string& path);

}  // namespace vesalius::cli
