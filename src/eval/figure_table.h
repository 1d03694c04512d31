#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "eval/interval.h"

namespace vesalius {

/// What one frame adds to a figure. Every figure is a ratio of two sums over the frames.
struct FigureTerm {
  std::string name;  ///< of docs/metrics.md, e.g. "people.found"
  double numerator = 0.0;
  double denominator = 1.0;
};
using FigureTerms = std::vector<FigureTerm>;

/// What kind of number a figure of this name is.
struct FigureKind {
  bool higher_is_better = true;
  bool trials = false;  ///< a share of separate trials, whose interval is Wilson's; else the bootstrap's
  bool metres = false;  ///< else a ratio
};
FigureKind kind_of(std::string_view name);

/// A figure of a set of frames.
struct Estimate {
  std::string name;
  double value = 0.0;
  Interval interval;
  double numerator = 0.0;
  double denominator = 0.0;
  std::vector<double> replicates;  ///< kReplicates values of the resampled set; NaN where it held no term
};

/// The one of that name; null for none.
const Estimate* find_estimate(const std::vector<Estimate>& estimates, std::string_view name);

/// Sums the terms of a set's frames; its size does not depend on their number.
class FigureTable {
 public:
  /// Throws Error for a term that is not finite.
  void add(std::uint64_t key, const FigureTerms& terms);
  /// The figures whose denominators are not 0, in the order of their first terms; behind those, the means of groups:
  /// `pixels.mean_recall` of all `pixels.recall.*` and so on (docs/metrics.md).
  std::vector<Estimate> estimates() const;
  /// Which frames were added, whatever their order.
  std::uint64_t frames_key() const { return frames_key_; }

 private:
  struct Sums {
    std::string name;
    double numerator = 0.0;
    double denominator = 0.0;
    std::array<double, kReplicates> numerators{};
    std::array<double, kReplicates> denominators{};
  };

  static Estimate estimate(const Sums& sums);
  void add_group_mean(std::string_view group, std::string_view name, std::vector<Estimate>& estimates) const;

  std::vector<Sums> sums_;
  std::unordered_map<std::string, std::size_t> index_;
  std::uint64_t frames_key_ = 0;
};

}  // namespace vesalius
