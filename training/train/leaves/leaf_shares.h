#pragma once

#include <cstdint>
#include <vector>

#include "train/messages/grow_options.h"
#include "train/messages/training_messages.h"
#include "vesalius/forest.h"

namespace vesalius {

/// Computes the class shares of leaves.
class LeafShares {
 public:
  /// `counts` are those of all samples; the first `parts` classes are body parts. `options` say how far shares
  /// compensate for the sizes of the classes.
  LeafShares(const SampleCounts& counts, int parts, const LeafOptions& options);

  /// Returns the shares of the four largest classes (the lower one on a tie) in 1/255, rounded down. `counts` are the
  /// leaf's samples of each class, not all 0.
  TreeLeaf leaf(const std::int64_t* counts) const;

 private:
  void balance_parts(const std::int64_t* counts, std::vector<std::uint64_t>& shares) const;

  std::vector<std::uint64_t> weights_;  ///< weight of one sample of a class, up to 2^24
  std::vector<std::uint64_t> balance_;  ///< likewise for distributing among the parts; empty if equal to weights_
};

}  // namespace vesalius
