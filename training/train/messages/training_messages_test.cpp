#include "train/messages/training_messages.h"

#include <gmock/gmock.h>

#include "train/split_histogram.h"
#include "vesalius/base/random.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr int kClasses = 6, kWidth = 32;

/// Rows of one node. Some classes occur only in its last third.
struct Rows {
  std::vector<std::int16_t> values;
  std::vector<std::uint8_t> labels;

  FeatureRows part(std::size_t begin, std::size_t end) const {
    return {values.data() + begin * kWidth, labels.data() + begin, end - begin, kWidth};
  }
  FeatureRows all() const { return part(0, labels.size()); }
};

Rows random_rows(std::size_t count, Random& random) {
  Rows rows;
  for (std::size_t r = 0; r < count; ++r) {
    const auto label = static_cast<std::uint8_t>(r < 2 * count / 3 ? 1 + 2 * random.below(2) : random.below(kClasses));
    rows.labels.push_back(label);
    for (int c = 0; c < kWidth; ++c) {
      rows.values.push_back(static_cast<std::int16_t>(std::lround(random.normal(50.0 * label, 100.0 + 20.0 * c))));
    }
  }
  return rows;
}

/// Returns the driver's split from the replies of shards that have rows [ends[i - 1], ends[i]).
ThresholdSplit split_over(const Rows& rows, const std::vector<std::size_t>& ends) {
  std::vector<FeatureRows> shards;
  for (std::size_t i = 0; i < ends.size(); ++i) shards.push_back(rows.part(i > 0 ? ends[i - 1] : 0, ends[i]));
  const auto merged = [&](const auto& ask) {
    auto all = ask(shards.front());
    for (std::size_t i = 1; i < shards.size(); ++i) merge(all, ask(shards[i]));
    return all;
  };
  const EntropyTable entropy;
  const NodeValues values = merged([](const FeatureRows& shard) { return node_values(shard, kClasses); });
  const CountTask task{{values.ranges, 16}, ClassIndex(values.class_counts)};
  const SplitHistogram histogram = merged([&](const FeatureRows& shard) { return count_bins(shard, task); });
  const BinChoice best = choose_bin(histogram, kWidth, task.classes, 20, entropy);
  const ValueInterval interval = beside(best.split, task.binning, 0);
  return refine_split(merged([&](const FeatureRows& shard) { return values_in(shard, interval); }), best, task.classes,
                      20, entropy);
}

TEST(TrainingMessages, GiveTheSameSplitsMergedAsFromOneShard) {
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    const Rows rows = random_rows(700, random);
    const ThresholdSplit whole = split_over(rows, {700});
    EXPECT_GT(whole.gain, 0.0);
    for (const std::vector<std::size_t>& ends :
         {std::vector<std::size_t>{300, 700}, {0, 1, 466, 466, 700}, {700, 700}}) {
      const ThresholdSplit split = split_over(rows, ends);
      EXPECT_EQ(split.threshold_mm, whole.threshold_mm);
      EXPECT_EQ(split.gain, whole.gain);
    }
  }
}

TEST(TrainingMessages, RefuseToMergeRepliesAboutDifferentThings) {
  NodeValues values{{1, 2}, ValueRanges(16)};
  EXPECT_THROW(merge(values, {{1, 2, 3}, ValueRanges(16)}), Error);
  EXPECT_THROW(merge(values, {{1, 2}, ValueRanges(32)}), Error);
  SplitHistogram histogram(2, 8);
  EXPECT_THROW(merge(histogram, SplitHistogram(3, 8)), Error);
  EXPECT_THROW(merge(histogram, SplitHistogram(2, 16)), Error);
  EXPECT_THROW(merge(histogram, SplitHistogram(4, 4)), Error) << "as many counts";
  ChildCounts children{2, {1, 2, 3, 4}};
  EXPECT_THROW(merge(children, {2, {1, 2}}), Error);
  EXPECT_THROW(merge(children, {4, {1, 2, 3, 4}}), Error);
  std::vector<NodeValues> nodes{values};
  EXPECT_THROW(merge(nodes, std::vector<NodeValues>{values, values}), Error);
  HardCounts hard{0, std::vector<std::uint64_t>(256, 0)};
  EXPECT_THROW(merge(hard, {0, std::vector<std::uint64_t>(511, 0)}), Error);
  SampleCounts samples{{1, 2}, {3, 4}};
  EXPECT_THROW(merge(samples, {{1}, {3}}), Error);
}

TEST(TrainingMessages, RefuseCountsBeyondSixteenBits) {
  SplitHistogram histogram(1, 2);
  SplitHistogram other = histogram;
  histogram.counts[5] = 65000;
  other.counts[5] = 535;
  merge(histogram, other);
  EXPECT_EQ(histogram.counts[5], 65535);
  other.counts[5] = 1;
  EXPECT_THROW(merge(histogram, other), Error);
}

TEST(ClassIndex, NumbersOccurringClassesWithoutGaps) {
  const ClassIndex classes(std::vector<std::int32_t>{0, 4, 0, 0, 9, 1});
  EXPECT_THAT(classes.totals, testing::ElementsAre(4, 9, 1));
  EXPECT_EQ(classes.index[1], 0);
  EXPECT_EQ(classes.index[4], 1);
  EXPECT_EQ(classes.index[5], 2);
}

TEST(ChildSizes, AddUpTheClasses) {
  EXPECT_THAT(child_sizes({3, {1, 2, 3, 0, 0, 0, 5, 0, 1}}), testing::ElementsAre(6, 0, 6));
}

TEST(HardCut, TakesTheWorstAndTheEarlierOfEquals) {
  HardCounts first{0, {0, 0, 0, 2, 4, 1}}, second{0, {0, 0, 0, 0, 3, 2}};
  HardCounts all = first;
  merge(all, second);
  const auto taken = [&](std::uint64_t most) {
    HardCut cut = hard_cut(all, most);
    std::vector<std::uint64_t> of_shard;
    for (const HardCounts* shard : {&first, &second}) {
      const HardCut part = take_part(cut, *shard);
      std::uint64_t count = part.ties;
      for (std::size_t share = part.above + 1; share < shard->counts.size(); ++share) count += shard->counts[share];
      of_shard.push_back(count);
    }
    return of_shard;
  };
  EXPECT_THAT(taken(0), testing::ElementsAre(0, 0));
  EXPECT_THAT(taken(2), testing::ElementsAre(1, 1));
  EXPECT_THAT(taken(3), testing::ElementsAre(1, 2));
  EXPECT_THAT(taken(6), testing::ElementsAre(4, 2));
  EXPECT_THAT(taken(8), testing::ElementsAre(5, 3));
  EXPECT_THAT(taken(10), testing::ElementsAre(5, 5));
  EXPECT_THAT(taken(11), testing::ElementsAre(6, 5));
  EXPECT_THAT(taken(100), testing::ElementsAre(7, 5));
}

}  // namespace
}  // namespace vesalius
