#include <fmt/format.h>

#include <cmath>

#include "cli/evaluate_report.h"
#include "cli/text_sink.h"
#include "eval/fit_score.h"
#include "io/options_file.h"

namespace vesalius::cli {
namespace {

/// A hundredth of a weight changes no score by more than a quarter of that.
float rounded(float weight) { return std::round(weight * 100.F) / 100.F; }

}  // namespace

void write_fitted_score(const Evaluation& evaluation, const std::string& path) {
  std::vector<std::vector<ScoreSample>> sets;
  for (const SetResult& set : evaluation.sets) sets.push_back(set.samples);
  const ScoreFit fit = fit_score(sets, evaluation.options.score);
  DetectOptions options = evaluation.options;
  options.score = fit.options;
  for (float* weight : {&options.score.likelihood_weight, &options.score.explained_weight, &options.score.open_weight,
                        &options.score.core_weight, &options.score.bias}) {
    *weight = rounded(*weight);
  }
  write_options([&](OptionVisitor& visitor) { visit_options("", options, visitor); }, path);
  print(fmt::format(
      "score fitted to {} candidates that were people and {} that were not: area under the curve {:.3f}, was {:.3f}\n",
      fit.people, fit.nobodies, fit.area_after, fit.area_before));
}

}  // namespace vesalius::cli
