#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "train/training_set.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// Class shares of leaves.
class LeafShares {
 public:
  /// Of the classes' sizes in `set`; `prior_correction` and `part_balance`: see LeafOptions.
  LeafShares(const TrainingSet& set, float prior_correction, float part_balance);

  /// Shares of the four largest classes (the lower one on a tie) in 1/255, rounded down. `counts`: samples of each
  /// class of the forest, not all 0.
  TreeLeaf leaf(const std::int64_t* counts) const;

 private:
  void balance_parts(const std::int64_t* counts, std::vector<std::uint64_t>& shares) const;

  std::vector<std::uint64_t> weights_;  ///< of one sample of a class, up to 2^24
  std::vector<std::uint64_t> balance_;  ///< the same of the parts among themselves; empty: as weights_
};

}  // namespace vesalius
