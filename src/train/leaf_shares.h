#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "train/training_set.h"
#include "vesalius/forest.h"

namespace vesalius {

/// Class shares of leaves.
class LeafShares {
 public:
  /// `prior_correction`: see LeafOptions.
  LeafShares(const TrainingSet& set, float prior_correction);

  /// Shares of the four largest classes (the lower one on a tie) in 1/255, rounded down. `counts`: samples of each
  /// class of the forest, not all 0.
  TreeLeaf leaf(const std::int64_t* counts) const;

 private:
  std::vector<std::uint64_t> weights_;  ///< of one sample of a class, up to 2^24
};

}  // namespace vesalius
