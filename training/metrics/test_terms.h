#pragma once

#include <limits>
#include <stdexcept>
#include <string>

#include "metrics/metric_table.h"

namespace vesalius::test {

/// Returns what these terms make of the metric with this name in files; NaN where they have none. Throws for a name
/// that no metric has.
inline double value_of(const MetricTerms& terms, const std::string& name) {
  if (!parse_metric(name)) throw std::runtime_error(name + ": no metric");
  double numerator = 0.0, denominator = 0.0;
  for (const MetricTerm& term : terms) {
    if (term.id.name() != name) continue;
    numerator += term.numerator;
    denominator += term.denominator;
  }
  return denominator > 0.0 ? numerator / denominator : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace vesalius::test
