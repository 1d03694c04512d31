#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/train/train_session.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// What growing trees came to.
struct GrowTotals {
  std::uint64_t evaluations = 0;  ///< of this run; trees of an earlier one do not count
  double seconds = 0.0;           ///< wall time of it
  int resumed = 0;                ///< trees that an earlier run had done
};

/// Trees of one round.
struct TreeRound {
  std::string name;  ///< "first round" in messages
  int first = 0;     ///< number of its first tree
  int count = 0;
  int at_once = 1;  ///< most trees grown at a time: each needs memory
};

/// Grows the trees of a round that `session` lacks, saves each as it is done, and returns all in order. Shows progress
/// where `shown`. Throws Error when the user interrupts: what is done is kept.
std::vector<Tree> grow_round(const TrainingSet& set, const TrainOptions& options, const TreeRound& round,
                             const TrainSession& session, const std::string& recipe, bool shown, GrowTotals& totals);

}  // namespace vesalius::cli
