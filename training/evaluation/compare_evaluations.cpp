#include "evaluation/compare_evaluations.h"

#include <algorithm>

namespace vesalius {

std::vector<SetComparison> compare_evaluations(const std::vector<StoredSet>& first,
                                               const std::vector<StoredSet>& second) {
  std::vector<SetComparison> sets;
  for (const StoredSet& set : first) {
    SetComparison& comparison = sets.emplace_back(SetComparison{set.name});
    const auto other = std::ranges::find(second, set.name, &StoredSet::name);
    if (other == second.end()) continue;
    comparison.in_both = true;
    comparison.paired = set.frames_key == other->frames_key;
    comparison.metrics = compare_common(set.metrics, other->metrics, comparison.paired);
  }
  return sets;
}

}  // namespace vesalius
