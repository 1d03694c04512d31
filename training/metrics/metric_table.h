#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metrics/metric.h"
#include "metrics/statistics.h"

namespace vesalius {

/// The term that one frame adds to a metric. Every metric is a ratio of two sums over the frames, or a mean of such
/// ratios.
struct MetricTerm {
  MetricId id;
  double numerator = 0.0;
  double denominator = 1.0;
};
using MetricTerms = std::vector<MetricTerm>;

/// A metric of a set of frames.
struct Estimate {
  MetricId id;
  double value = 0.0;
  Interval interval{};
  double numerator = 0.0;
  double denominator = 0.0;
  std::vector<double> replicates{};  ///< kReplicates values of the resampled set; NaN if it had no term
};

/// Returns the estimate of a metric, for a family the one with that parameter; null if there is none.
const Estimate* find_estimate(const std::vector<Estimate>& estimates, Metric metric, std::string_view parameter = "");

/// Returns an estimate's value with its interval: "97.20 % (95.10 to 98.40)".
std::string text_with_interval(const Estimate& estimate);

/// Sums the terms of a set's frames. Its size does not depend on their number.
class MetricTable {
 public:
  /// Adds a frame; `key` names it (frame_key). Throws Error for a term that is not finite.
  void add(std::uint64_t key, const MetricTerms& terms);
  /// Returns the metrics whose denominators are not 0, and the means of families, in the order of kMetrics.
  std::vector<Estimate> estimates() const;
  /// Returns a hash of the frames that were added, whatever their order.
  std::uint64_t frames_key() const { return frames_key_; }

 private:
  struct Sums {
    int place = 0;  ///< the smallest place given for this member of a family
    double numerator = 0.0;
    double denominator = 0.0;
    std::array<double, kReplicates> numerators{};
    std::array<double, kReplicates> denominators{};
  };

  static Estimate estimate(MetricId id, const Sums& sums);
  std::vector<Estimate> estimates_of(Metric metric) const;

  std::map<std::pair<Metric, std::string>, Sums> sums_;  ///< by metric and parameter
  std::uint64_t frames_key_ = 0;
};

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
