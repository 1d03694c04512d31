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

}  // namespace vesalius
