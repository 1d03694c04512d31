#include "evaluation/evaluation_summary.h"

#include <fmt/format.h>

namespace vesalius {
namespace {

/// Returns e.g. ", people 56 of 56, false 0".
std::string people_text(const SetResult& set, const std::vector<Estimate>& estimates) {
  std::string text;
  if (const Estimate* found = find_estimate(estimates, Metric::people_found)) {
    text += fmt::format(", people {:.0f} of {:.0f}", found->numerator, found->denominator);
  }
  if (const Estimate* wrong = find_estimate(estimates, Metric::people_false)) {
    text += fmt::format(", false {:.0f}", wrong->numerator);
  }
  if (const Estimate* empty = find_estimate(estimates, Metric::empty_with_person)) {
    text += fmt::format(", somebody in {:.0f} of {:.0f} empty", empty->numerator, empty->denominator);
  }
  if (set.failed > 0) text += fmt::format(", {} failed", set.failed);
  return text;
}

}  // namespace

std::string speed_text(const SetResult& set) {
  return fmt::format("{:.1f} frames/s", set.frames / std::max(1e-9, set.seconds));
}

std::string summary_lines(const SetResult& set) {
  const std::vector<Estimate> estimates = set.metrics.estimates();
  std::string text =
      fmt::format("{}: {} frames{}, {}\n", set.name, set.frames, people_text(set, estimates), speed_text(set));
  for (const Metric metric : kOverview) {
    const Estimate* estimate = find_estimate(estimates, metric);
    if (estimate == nullptr || metric <= Metric::empty_with_person) continue;
    text += fmt::format("  {:<24} {}\n", info(metric).title, text_with_interval(*estimate));
  }
  return text;
}

}  // namespace vesalius
