#include "train/local_executor.h"

#include <gtest/gtest.h>

#include <atomic>

#include "train/grow_forest.h"
#include "train/test_training.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using test::small_options;
using test::train_over;

std::vector<LabelledFrame> frames_of(int count) { return test::noisy_frames(count, 0.7); }

/// Counts the reports of a training, and may stop it after some trees.
class Listener : public TrainObserver {
 public:
  explicit Listener(int stop_after = 1000) : stop_after_(stop_after) {}
  void begin_round(const TreeRound& round, GrowProgress& progress) override {
    missing += round.missing;
    progress_ = &progress;
    progress.stop = trees >= stop_after_;
  }
  void add_tree(const Tree& /*tree*/) override { progress_->stop = ++trees >= stop_after_; }
  void end_round() override { ++rounds; }
  void add_hard_negatives(std::size_t samples) override { hard_negatives += samples; }

  int missing = 0, rounds = 0;
  std::atomic<int> trees{0};
  std::size_t hard_negatives = 0;

 private:
  int stop_after_;
  GrowProgress* progress_ = nullptr;
};

Forest train_over(const std::vector<int>& ends, const std::vector<LabelledFrame>& frames, const TrainOptions& options,
                  std::size_t* hard_negatives = nullptr) {
  MemoryTreeStore store;
  Listener listener;
  Forest forest = train_over(ends, frames, options, store, listener);
  if (hard_negatives != nullptr) *hard_negatives = listener.hard_negatives;
  return forest;
}

TEST(LocalExecutor, GrowsTheSameForestFromAnyNumberOfShards) {
  const std::vector<LabelledFrame> frames = frames_of(24);
  for (const float hard_share : {0.F, 0.05F, 0.2F, 10.F}) {  // none, some with ties at the cut, all
    TrainOptions options = small_options();
    options.sample.hard_share = hard_share;
    std::size_t whole_hard = 0;
    const Forest whole = train_over({24}, frames, options, &whole_hard);
    EXPECT_EQ(whole_hard > 0, hard_share > 0.F);
    EXPECT_EQ(grow_forest(frames, paper_body(), options).trees, whole.trees);
    for (const std::vector<int>& ends : {std::vector<int>{11, 24}, {3, 4, 4, 15, 24}}) {
      std::size_t hard = 0;
      EXPECT_EQ(train_over(ends, frames, options, &hard).trees, whole.trees) << ends.size() << " shards";
      EXPECT_EQ(hard, whole_hard);
    }
  }
}

TEST(LocalExecutor, GrowsTheSameForestWithoutBackgroundClass) {
  const std::vector<LabelledFrame> frames = frames_of(8);
  TrainOptions options = small_options();
  options.sample.background_share = 0.F;
  options.grow.split.split_pixels = 100;
  options.grow.leaf.prior_correction = 0.5F;
  EXPECT_EQ(train_over({3, 4, 8}, frames, options).trees, train_over({8}, frames, options).trees);
}

TEST(TrainForest, ContinuesFromStoredTreesWithTheSameForest) {
  const std::vector<LabelledFrame> frames = frames_of(12);
  const TrainOptions options = small_options();
  const Forest whole = train_over({12}, frames, options);
  for (const int stop_after : {0, 1, 2, 3}) {
    MemoryTreeStore store;
    Listener first(stop_after);
    EXPECT_THROW(train_over({12}, frames, options, store, first), Interrupted);
    EXPECT_EQ(first.trees, stop_after);
    EXPECT_EQ(first.rounds, stop_after < 2 ? 1 : 2) << "rounds end where they are cut short";
    Listener second;
    EXPECT_EQ(train_over({12}, frames, options, store, second).trees, whole.trees);
    EXPECT_EQ(second.trees, 4 - stop_after);
    EXPECT_EQ(second.missing, 4 - stop_after);
  }
}

TEST(TrainForest, GrowsTheSameForestForAnyNumberOfTreesAtOnce) {
  const std::vector<LabelledFrame> frames = frames_of(12);
  TrainOptions options = small_options();
  options.trees = 5;
  const Forest one = train_over({12}, frames, options);
  MemoryTreeStore store;
  Listener listener;
  EXPECT_EQ(train_over({5, 12}, frames, options, store, listener, 3).trees, one.trees);
  EXPECT_EQ(listener.trees, 7);
  EXPECT_EQ(listener.rounds, 2);
}

TEST(TrainForest, RefusesShardsWithoutSamples) {
  const std::vector<LabelledFrame> frames = frames_of(1);
  EXPECT_THROW(train_over({0, 0}, frames, small_options()), Error);
}

}  // namespace
}  // namespace vesalius
