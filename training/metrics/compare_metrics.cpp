#include "metrics/compare_metrics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace vesalius {
namespace {

Interval paired_interval(const Estimate& first, const Estimate& second) {
  std::vector<double> differences;
  const std::size_t count = std::min(first.replicates.size(), second.replicates.size());
  for (std::size_t r = 0; r < count; ++r) differences.push_back(second.replicates[r] - first.replicates[r]);
  return percentile_interval(std::move(differences));
}

Interval independent_interval(const Estimate& first, const Estimate& second, double difference) {
  const double down = std::hypot(second.value - second.interval.low, first.interval.high - first.value);
  const double up = std::hypot(second.interval.high - second.value, first.value - first.interval.low);
  return {difference - down, difference + up};
}

/// Returns whether a change is for the better; `up` says that it surely is one upwards.
bool is_better(const Comparison& change, bool up) {
  switch (info(change.id.metric).direction) {
    case MetricDirection::higher_is_better:
      return up;
    case MetricDirection::lower_is_better:
      return !up;
    default:
      return std::abs(change.second) < std::abs(change.first);
  }
}

}  // namespace

Comparison compare(const Estimate& first, const Estimate& second, bool paired) {
  Comparison result{first.id};
  result.first = first.value;
  result.second = second.value;
  result.difference = second.value - first.value;
  result.interval = paired ? paired_interval(first, second) : independent_interval(first, second, result.difference);
  const bool up = result.interval.low > 0.0;
  const bool down = result.interval.high < 0.0;
  if (up || down) {
    result.verdict = is_better(result, up) ? Comparison::Verdict::better : Comparison::Verdict::worse;
  }
  return result;
}

std::vector<Comparison> compare_common(const std::vector<Estimate>& first, const std::vector<Estimate>& second,
                                       bool paired) {
  std::vector<Comparison> all;
  for (const Estimate& estimate : first) {
    const Estimate* other = find_estimate(second, estimate.id.metric, estimate.id.parameter);
    if (other != nullptr) all.push_back(compare(estimate, *other, paired));
  }
  std::ranges::stable_sort(all, {}, [](const Comparison& c) { return c.id.metric; });
  return all;
}

const char* verdict_word(Comparison::Verdict verdict) {
  return verdict == Comparison::Verdict::better ? "better" : verdict == Comparison::Verdict::worse ? "worse" : "same";
}

}  // namespace vesalius
