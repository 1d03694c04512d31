#pragma once

#include <string>

#include "eval/figure_table.h"

namespace vesalius {

/// One figure of two evaluations.
struct Comparison {
  enum class Verdict { better, worse, same };  ///< of the second; same: the interval of the difference holds 0
  std::string name;
  double first = 0.0;
  double second = 0.0;
  double difference = 0.0;  ///< second - first
  Interval interval;        ///< of the difference, 95 %
  Verdict verdict = Verdict::same;
};

/// Compares two estimates of one figure. `paired`: both saw the same frames, so that their resamples are the same ones
/// and the difference is resampled; else Newcombe's interval of a difference of independent figures (method 10 of
/// R. G. Newcombe 1998) is made from theirs.
Comparison compare(const Estimate& first, const Estimate& second, bool paired);

}  // namespace vesalius
