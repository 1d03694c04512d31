#include <fmt/format.h>

#include <cmath>

#include "cli/evaluate/evaluate_report.h"
#include "cli/text_sink.h"
#include "eval/fit_score.h"
#include "io/files/options_file.h"

namespace vesalius::cli {
namespace {

/// A hundredth of a weight changes no score by more than a quarter of that.
float rounded(float weight) { return std::round(weight * 100.F) / 100.F; }

}  // namespace

void write_fitted_score(const Evaluation& evaluation, const std::string& path) {
  std::vector<std::vector<ScoreSample>> sets;
  for (const SetResult& set : evaluation.sets) sets.push_back(set.samples);
  DetectOptions options = evaluation.options;
  ScoreOptions& score = evaluation.has_background ? options.score : options.score_without_background;
  const ScoreFit fit = fit_score(sets, score);
  score = fit.options;
  for (const EvidenceWeight& piece : kEvidenceWeights) score.*piece.weight = rounded(score.*piece.weight);
  score.bias = rounded(score.bias);
  write_options([&](OptionVisitor& visitor) { visit_options("", options, visitor); }, path);
  print(fmt::format(
      "score fitted to {} candidates that were people and {} that were not: area under the curve {:.3f}, was {:.3f}\n",
      fit.people, fit.nobodies, fit.area_after, fit.area_before));
}

}  // namespace vesalius::cli
