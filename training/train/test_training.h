#pragma once

#include <vector>

#include "capsule/capsule_person.h"
#include "train/grow_forest.h"
#include "train/local_executor.h"
#include "vesalius/base/random.h"

// Training over several shards, which tests share.
namespace vesalius::test {

/// Returns noisy frames of 80x60 pixels of people who are turned by at most `most_yaw`, every fourth of an empty room.
inline std::vector<LabelledFrame> noisy_frames(int count, double most_yaw) {
  std::vector<LabelledFrame> frames;
  for (int i = 0; i < count; ++i) {
    Random random(5, static_cast<std::uint64_t>(i));
    CapsuleScene scene;
    if (i % 4 != 3) {
      CapsulePerson person;
      person.pose.yaw = static_cast<float>(random.uniform(-most_yaw, most_yaw));
      person.pose.l_arm.raise = static_cast<float>(random.uniform(0.2, 2.5));
      person.feet.x() = static_cast<float>(random.uniform(-0.5, 0.5));
      scene.people = {person};
    }
    frames.push_back(render(scene, {80, 60, 66.F, 66.F, 39.5F, 29.5F}, paper_body()));
    add_sensor_noise(frames.back().frame, static_cast<std::uint64_t>(i));
  }
  return frames;
}

/// Returns options of a training that takes well under a second.
inline TrainOptions small_options() {
  TrainOptions options;
  options.trees = 2;
  options.hard_trees = 2;
  options.sample.pixels_per_frame = 200;
  options.sample.held_out_share = 0.1F;
  options.sample.hard_pool = 1000;
  options.grow.leaf.max_depth = 6;
  options.grow.leaf.min_samples = 4;
  options.grow.split.candidates = 12;
  return options;
}

/// Returns shards; shard i has the frames [ends[i - 1], ends[i]).
inline std::vector<TrainingSet> shards_of(const std::vector<int>& ends, const std::vector<LabelledFrame>& frames,
                                          const TrainOptions& options) {
  std::vector<TrainingSet> sets;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const int begin = i > 0 ? ends[i - 1] : 0;
    sets.emplace_back(paper_body(), training_convention(options), options.sample, 1, begin);
    for (int f = begin; f < ends[i]; ++f) sets.back().add(frames[f]);
  }
  return sets;
}

inline std::vector<TrainingSet*> pointers_to(std::vector<TrainingSet>& sets) {
  std::vector<TrainingSet*> pointers;
  for (TrainingSet& set : sets) pointers.push_back(&set);
  return pointers;
}

/// Trains on shards.
inline Forest train_over(const std::vector<int>& ends, const std::vector<LabelledFrame>& frames,
                         const TrainOptions& options, TreeStore& store, TrainObserver& observer,
                         int trees_at_once = 1) {
  std::vector<TrainingSet> sets = shards_of(ends, frames, options);
  LocalExecutor executor(pointers_to(sets), trees_at_once);
  return train_forest(executor, sets.front().untrained_forest(), options, store, observer);
}

}  // namespace vesalius::test
