#include "cuda_train/device_executor.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "cuda/cuda_device.h"
#include "cuda_train/test_simulated_training.h"
#include "train/grow_forest.h"
#include "train/test_training.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/error.h"

namespace vesalius::gpu {
namespace {

using test::pointers_to;
using test::shards_of;
using test::simulated_training;

/// With hard negatives, several counted samples a node and joint leaves.
TrainOptions small_options() {
  TrainOptions options = test::small_options();
  options.sample.hard_share = 0.05F;
  options.grow.leaf.max_depth = 7;
  options.grow.split.candidates = 24;
  options.grow.split.split_pixels = 600;
  options.leaves.rounds = 3;
  options.leaves.portions = 2;
  return options;
}

Forest train_on(const std::vector<std::shared_ptr<Device>>& devices, const std::vector<int>& ends,
                const std::vector<LabelledFrame>& frames, const TrainOptions& options, int trees_at_once = 1) {
  std::vector<TrainingSet> sets = shards_of(ends, frames, options);
  DeviceExecutor executor(pointers_to(sets), devices, trees_at_once);
  MemoryTreeStore store;
  TrainObserver observer;
  return train_forest(executor, sets.front().untrained_forest(), options, store, observer);
}

Forest train_on_processor(const std::vector<LabelledFrame>& frames, const TrainOptions& options) {
  MemoryTreeStore store;
  TrainObserver observer;
  return test::train_over({static_cast<int>(frames.size())}, frames, options, store, observer);
}

void expect_same(const Forest& found, const Forest& expected) {
  ASSERT_EQ(found.trees.size(), expected.trees.size());
  for (std::size_t t = 0; t < found.trees.size(); ++t) {
    EXPECT_TRUE(found.trees[t].nodes == expected.trees[t].nodes) << "tree " << t;
    EXPECT_TRUE(found.trees[t].leaves == expected.trees[t].leaves) << "tree " << t;
    EXPECT_TRUE(found.trees[t].logits == expected.trees[t].logits) << "tree " << t;
  }
  EXPECT_EQ(found.logit_unit, expected.logit_unit);
  EXPECT_EQ(found.facing, expected.facing);
}

/// Returns frames of people, of some of whom nobody knows which way they face.
std::vector<LabelledFrame> frames_of(int count) {
  std::vector<LabelledFrame> frames = test::noisy_frames(count, 3.1);
  for (int i = 1; i < count; i += 4) frames[i].parts.clear();
  return frames;
}

TEST(DeviceExecutor, GrowsTheForestOfTheProcessor) {
  const std::vector<LabelledFrame> frames = frames_of(24);
  const TrainOptions options = small_options();
  const Forest expected = train_on_processor(frames, options);
  ASSERT_GT(expected.trees[0].nodes.size(), 20U);
  ASSERT_FALSE(expected.trees[0].logits.empty());
  for (const bool backwards : {false, true}) {
    expect_same(train_on({simulated_training({.simulator = {.backwards = backwards}})}, {24}, frames, options),
                expected);
  }
}

TEST(DeviceExecutor, GrowsTheSameForestFromShardsOnSeveralDevices) {
  const std::vector<LabelledFrame> frames = frames_of(24);
  const TrainOptions options = small_options();
  const Forest expected = train_on_processor(frames, options);
  expect_same(train_on({simulated_training()}, {11, 24}, frames, options), expected);
  expect_same(train_on({simulated_training(), simulated_training()}, {3, 4, 4, 15, 24}, frames, options), expected);
  for (const std::size_t devices : {2, 3, 30}) {  // which divide a set among them, the last in part with nothing
    std::vector<std::shared_ptr<Device>> all;
    for (std::size_t i = 0; i < devices; ++i) all.push_back(simulated_training());
    expect_same(train_on(all, {24}, frames, options), expected);
  }
}

TEST(DeviceExecutor, GrowsTheSameForestWithOtherOptions) {
  const std::vector<LabelledFrame> frames = frames_of(12);
  std::vector<TrainOptions> all(5, small_options());
  all[0].grow.split.candidates = 150;  // three blocks, the last with 22 candidates
  all[1].grow.split.shared_features = 40;
  all[1].grow.row_bytes = 200'000;  // many groups
  all[2].sample.background_share = 0.F;
  all[2].grow.split.bins = 2;
  all[3].probe_clip_m = 0.F;
  all[3].leaves.headings = 0;
  all[4].leaves.rounds = 0;
  all[4].grow.split.split_pixels = 65535;
  all[4].grow.split.candidates = 5;
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE("options " + std::to_string(i));
    expect_same(train_on({simulated_training()}, {12}, frames, all[i]), train_on_processor(frames, all[i]));
  }
}

// Labels: threads
TEST(DeviceExecutor, GrowsTheSameForestForAnyNumberOfTreesAtOnce) {
  const std::vector<LabelledFrame> frames = frames_of(6);
  TrainOptions options = small_options();
  options.trees = 3;
  options.leaves.rounds = 0;
  options.grow.leaf.max_depth = 4;
  options.grow.split.candidates = 16;
  const Forest expected = train_on_processor(frames, options);
  for_threads({4}, [&] { expect_same(train_on({simulated_training()}, {3, 6}, frames, options, 3), expected); });
}

TEST(DeviceExecutor, SaysWhenADeviceIsTooSmallOrLost) {
  const std::vector<LabelledFrame> frames = frames_of(6);
  const TrainOptions options = small_options();
  EXPECT_THAT([&] { train_on({simulated_training({.memory_bytes = 5000})}, {6}, frames, options); },
              testing::ThrowsMessage<DeviceError>(testing::HasSubstr("no room for")));
  for (const int after : {10, 40, 200}) {
    EXPECT_THAT([&] { train_on({simulated_training({.lost_after = after})}, {6}, frames, options); },
                testing::ThrowsMessage<DeviceError>(testing::HasSubstr("the device was lost")));
  }
}

TEST(DeviceExecutor, NeedsEveryBarrierOfTheGradient) {
  const std::vector<LabelledFrame> frames = frames_of(8);
  const Forest expected = train_on_processor(frames, small_options());
  for (int barrier = 0; barrier < 6; ++barrier) {
    bool found = false;
    for (const bool backwards : {false, true}) {
      const SimulatorOptions simulator{.backwards = backwards, .zeroed = true, .faults = {.left_out_barrier = barrier}};
      const auto device = simulated_training({.simulator = simulator, .faulty_kernel = GradientArguments::kName});
      found = found || train_on({device}, {8}, frames, small_options()).trees != expected.trees;
    }
    EXPECT_TRUE(found) << "barrier " << barrier;
  }
}

// Labels: slow statistics
TEST(DeviceExecutor, GrowsTheForestOfTheProcessorFromManyFrames) {
  const char* given = std::getenv("VESALIUS_TRAIN_FRAMES");  // 2,000 in .ci/nightly
  const int count = given != nullptr ? std::stoi(given) : 100;
  const std::vector<LabelledFrame> frames = frames_of(count);
  TrainOptions options = small_options();
  options.grow.leaf.max_depth = 12;
  options.grow.split.candidates = 64;
  options.grow.split.split_pixels = 20000;
  options.sample.hard_pool = 100'000;
  options.sample.pixels_per_frame = 100;
  const Forest expected = train_on_processor(frames, options);
  ASSERT_GT(expected.trees[0].nodes.size(), 100U);
  expect_same(train_on({simulated_training(), simulated_training()}, {2 * count / 3, count}, frames, options),
              expected);
  expect_same(train_on({simulated_training()}, {count}, frames, options), expected);
}

// Labels: gpu
TEST(DeviceExecutor, GrowsTheForestOfTheProcessorOnACard) {
  std::shared_ptr<Device> card;
  try {
    card = open_cuda_device(0, train_kernels_on_cards());
  } catch (const DeviceError& e) {
    GTEST_SKIP() << e.what();
  }
  const std::vector<LabelledFrame> frames = frames_of(60);
  const TrainOptions options = small_options();
  const Forest expected = train_on_processor(frames, options);
  expect_same(train_on({card}, {60}, frames, options), expected);
  expect_same(train_on({card}, {10, 60}, frames, options, 2), expected);
}

}  // namespace
}  // namespace vesalius::gpu
