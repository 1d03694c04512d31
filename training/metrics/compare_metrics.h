#pragma once

#include <vector>

#include "metrics/metric_table.h"

namespace vesalius {

/// One metric of two evaluations.
struct Comparison {
  enum class Verdict { better, worse, same };  ///< of the second one; same if the interval of the difference contains 0
  MetricId id;
  double first = 0.0;
  double second = 0.0;
  double difference = 0.0;  ///< second - first
  Interval interval{};      ///< 95 % interval of the difference
  Verdict verdict = Verdict::same;
};

/// Compares two estimates of one metric. If `paired` is true, both saw the same frames: their resamples are then the
/// same, and the interval is that of the resampled difference. Otherwise it is Newcombe's interval of a difference of
/// independent estimates (method 10 of R. G. Newcombe 1998).
Comparison compare(const Estimate& first, const Estimate& second, bool paired);

/// Compares every metric that both have, in the order of kMetrics.
std::vector<Comparison> compare_common(const std::vector<Estimate>& first, const std::vector<Estimate>& second,
                                       bool paired);

/// Returns "better", "worse" or "same".
const char* verdict_word(Comparison::Verdict verdict);

}  // namespace vesalius
