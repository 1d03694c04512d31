#include "evaluation/evaluation_csv.h"

#include <fmt/format.h>

#include <algorithm>

#include "metrics/compare_metrics.h"

namespace vesalius {
namespace {

std::string field(std::string text) {
  std::ranges::replace(text, ',', ';');
  return text;
}

}  // namespace

std::string evaluation_csv(const Evaluation& evaluation) {
  std::string csv = "set,figure,value,low,high,numerator,denominator,better\n";
  for (const SetResult& set : evaluation.sets) {
    const std::string name = field(set.name);
    for (const Estimate& e : set.metrics.estimates()) {
      csv += fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.10g},{:.10g},{}\n", name, e.id.name(), e.value, e.interval.low,
                         e.interval.high, e.numerator, e.denominator, better_word(e.id.metric));
    }
  }
  return csv;
}

std::string ablation_csv(const std::vector<SetResult>& sets) {
  std::string csv = "set,variant,figure,value,difference,low,high,verdict\n";
  for (const SetResult& set : sets) {
    if (set.ablation.empty()) continue;
    const std::string name = field(set.name);
    const std::vector<Estimate> whole = set.metrics.estimates();
    for (const Estimate& e : whole) csv += fmt::format("{},,{},{:.6g},,,,\n", name, e.id.name(), e.value);
    csv += fmt::format("{},,frame_ms,{:.6g},,,,\n", name, set.frame_ms);
    for (const AblationRow& row : set.ablation) {
      const std::string variant = field(row.variant);
      for (const Comparison& c : compare_common(whole, row.metrics, true)) {
        csv += fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{}\n", name, variant, c.id.name(), c.second,
                           c.difference, c.interval.low, c.interval.high, verdict_word(c.verdict));
      }
      csv += fmt::format("{},{},frame_ms,{:.6g},{:.6g},,,\n", name, variant, row.frame_ms, row.frame_ms - set.frame_ms);
    }
  }
  return csv;
}

}  // namespace vesalius
