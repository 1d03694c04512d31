#pragma once

#include <vector>

#include "train/grow_forest.h"
#include "train/local_executor.h"

// Training over several shards, which tests share.
namespace vesalius::test {

/// Trains on shards; shard i has the frames [ends[i - 1], ends[i]).
inline Forest train_over(const std::vector<int>& ends, const std::vector<LabelledFrame>& frames,
                         const TrainOptions& options, TreeStore& store, TrainObserver& observer,
                         int trees_at_once = 1) {
  std::vector<TrainingSet> sets;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const int begin = i > 0 ? ends[i - 1] : 0;
    sets.emplace_back(paper_body(), training_convention(options), options.sample, 1, begin);
    for (int f = begin; f < ends[i]; ++f) sets.back().add(frames[f]);
  }
  std::vector<TrainingSet*> shards;
  for (TrainingSet& set : sets) shards.push_back(&set);
  LocalExecutor executor(shards);
  return train_forest(executor, sets.front().untrained_forest(), options, store, observer, trees_at_once);
}

}  // namespace vesalius::test
