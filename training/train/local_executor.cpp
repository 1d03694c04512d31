#include "train/local_executor.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "train/grow_tree.h"
#include "train/leaves/leaf_shard.h"
#include "train/local_shards.h"
#include "vesalius/parallel.h"

namespace vesalius {

LocalExecutor::LocalExecutor(std::vector<TrainingSet*> sets, int trees_at_once)
    : sets_(std::move(sets)), trees_at_once_(trees_at_once) {}

void for_trees(const std::vector<int>& numbers, int at_once, const std::function<void(int)>& grow) {
  const auto count = int(numbers.size());
  for (int begin = 0; begin < count; begin += at_once) {
    parallel_for(std::min(count - begin, at_once), [&](int i) { grow(numbers[begin + i]); });
  }
}

void LocalExecutor::grow_trees(const Forest& forest, const GrowTreeOptions& options, const std::vector<int>& numbers,
                               GrowProgress& progress, const TakeTree& take) {
  const std::vector<const TrainingSet*> sets(sets_.begin(), sets_.end());
  for_trees(numbers, trees_at_once_, [&](int number) {
    LocalTree shards(sets, options, number);
    take(number, grow_tree(shards, forest, options, number, progress));
  });
}

HardCounts LocalExecutor::count_hard_negatives(const Forest& forest) {
  hard_.clear();
  for (TrainingSet* set : sets_) hard_.push_back(set->count_hard_negatives(forest));
  HardCounts all = hard_.front();
  for (std::size_t i = 1; i < hard_.size(); ++i) merge(all, hard_[i]);
  return all;
}

std::size_t LocalExecutor::add_hard_negatives(const HardCut& cut) {
  HardCut rest = cut;
  std::size_t added = 0;
  for (std::size_t i = 0; i < sets_.size(); ++i) added += sets_[i]->add_hard_negatives(take_part(rest, hard_[i]));
  return added;
}

std::unique_ptr<LeafExecutor> LocalExecutor::begin_leaves(const Forest& forest, const LogitLayout& layout) {
  return std::make_unique<LocalLeaves>(std::vector<const TrainingSet*>(sets_.begin(), sets_.end()), forest, layout);
}

std::vector<FacingSample> LocalExecutor::facing_samples(const Forest& forest) {
  std::vector<FacingSample> all;
  for (const TrainingSet* set : sets_)
    std::ranges::move(vesalius::facing_samples(*set, forest), std::back_inserter(all));
  return all;
}

}  // namespace vesalius
