#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "train/messages/training_protocol.h"
#include "train/samples/training_set.h"

namespace vesalius {

/// Calls `grow(number)` for trees, at most `at_once` at a time. They grow in batches: otherwise a thread that waits
/// within a tree may begin another one and hold the memory of both.
void for_trees(const std::vector<int>& numbers, int at_once, const std::function<void(int)>& grow);

/// All shards of a training within this process.
class LocalExecutor : public Executor {
 public:
  /// There must be at least one set, and all must outlive this object. At most `trees_at_once` trees grow at a time,
  /// each of which needs memory.
  explicit LocalExecutor(std::vector<TrainingSet*> sets, int trees_at_once = 1);

  void grow_trees(const Forest& forest, const GrowTreeOptions& options, const std::vector<int>& numbers,
                  GrowProgress& progress, const TakeTree& take) override;
  HardCounts count_hard_negatives(const Forest& forest) override;
  std::size_t add_hard_negatives(const HardCut& cut) override;
  std::unique_ptr<LeafExecutor> begin_leaves(const Forest& forest, const LogitLayout& layout) override;
  std::vector<FacingSample> facing_samples(const Forest& forest) override;

 private:
  std::vector<TrainingSet*> sets_;
  int trees_at_once_;
  std::vector<HardCounts> hard_;  ///< last counts of each set
};

}  // namespace vesalius
