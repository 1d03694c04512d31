#pragma once

#include <string>
#include <vector>

#include "evaluation/evaluation_json.h"
#include "metrics/compare_metrics.h"

namespace vesalius {

/// A set of the first evaluation beside the one of the same name in the second.
struct SetComparison {
  std::string name;
  bool in_both = false;
  bool paired = false;  ///< both saw the same frames
  std::vector<Comparison> metrics{};
};

/// Compares two evaluations set by set, in the order of the first one's sets.
std::vector<SetComparison> compare_evaluations(const std::vector<StoredSet>& first,
                                               const std::vector<StoredSet>& second);

}  // namespace vesalius
