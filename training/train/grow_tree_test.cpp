#include "train/grow_tree.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "capsule/capsule_person.h"
#include "train/growing_tree.h"
#include "train/local_shards.h"
#include "train/split_candidates.h"
#include "train/split_histogram.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/error.h"
#include "vesalius/forest/tree_walk.h"

namespace vesalius {
namespace {

/// The trainer in its plainest form: node by node and pixel by pixel on depth images, with the code of detection.
class ObviousTrainer {
 public:
  ObviousTrainer(const TrainingSet& set, const std::vector<LabelledFrame>& frames, const GrowTreeOptions& options,
                 int tree)
      : set_(set),
        frames_(frames),
        options_(options),
        tree_(tree),
        shares_(set.sample_counts(), set.body().part_count(), options.leaf) {}

  Tree grow() {
    grow_node({set_.samples().begin(), set_.samples().end()}, 1, 0);
    return pruned_tree(nodes_);
  }

 private:
  using Samples = std::vector<TrainingSample>;
  struct Choice {
    TreeNode node;
    double gain = 0.0;
  };

  int feature(const TrainingSample& sample, const TreeNode& node) const {
    const Frame& frame = frames_[sample.frame].frame;
    const OffsetScale scale = OffsetScaler(set_.convention(), frame.camera).at(sample.depth_mm);
    return std::clamp(feature_mm(frame.depth, set_.convention(), scale, sample.u, sample.v, node), -32768, 32767);
  }

  std::size_t grow_node(const Samples& samples, std::uint32_t number, int depth) {
    const std::size_t at = nodes_.size();
    nodes_.emplace_back();
    std::vector<std::int64_t> counts(set_.class_count(), 0);
    for (const TrainingSample& sample : samples) ++counts[sample.label];
    nodes_[at].leaf = shares_.leaf(counts.data());
    const bool pure = std::ranges::count_if(counts, [](std::int64_t n) { return n > 0; }) < 2;
    if (pure || depth >= options_.leaf.max_depth || std::ssize(samples) < 2 * options_.leaf.min_samples) return at;
    const Choice choice = choose(samples, number);
    if (choice.gain <= 0.0) return at;
    Samples left, right;
    for (const TrainingSample& sample : samples) {
      (feature(sample, choice.node) <= choice.node.threshold_mm ? left : right).push_back(sample);
    }
    const std::size_t left_at = grow_node(left, 2 * number, depth + 1);
    const std::size_t right_at = grow_node(right, 2 * number + 1, depth + 1);
    nodes_[at].split = choice.node;
    nodes_[at].left = left_at;
    nodes_[at].right = right_at;
    return at;
  }

  /// Returns evenly spaced samples, at most `split_pixels`.
  Samples counted(const Samples& samples) const {
    const auto size = std::ssize(samples);
    const auto most = std::min<std::ptrdiff_t>(size, options_.split.split_pixels);
    Samples result;
    for (std::ptrdiff_t i = 0; i < size; ++i) {
      if ((i + 1) * most / size > i * most / size) result.push_back(samples[i]);
    }
    return result;
  }

  Choice choose(const Samples& samples, std::uint32_t number) const {
    const Samples some = counted(samples);
    const auto least = (options_.leaf.min_samples * std::ssize(some) + std::ssize(samples) - 1) / std::ssize(samples);
    Choice best;
    for (int block = 0; block < candidate_blocks(options_.split); ++block) {
      const Choice choice = choose_of_block(some, node_candidates(set_.convention(), options_, tree_, number, block),
                                            static_cast<int>(least));
      if (choice.gain >= static_cast<double>(options_.split.min_gain) && choice.gain > best.gain) best = choice;
    }
    return best;
  }

  /// Returns the candidate whose best edge between bins has the highest score, with the best of all thresholds beside
  /// that edge.
  Choice choose_of_block(const Samples& samples, const CandidateTable& table, int least) const {
    int best_candidate = -1, best_bin = 0;
    std::int64_t best_score = std::numeric_limits<std::int64_t>::min();
    for (int c = 0; c < table.count; ++c) {
      const std::vector<int> values = values_of(samples, table.node(c));
      const Binning binning = binning_of(values);
      for (int b = 0; b + 1 < binning.bins; ++b) {
        const std::int64_t score = score_of(samples, values, binning.last_value(0, b), least);
        if (score > best_score) {
          best_score = score;
          best_candidate = c;
          best_bin = b;
        }
      }
    }
    if (best_candidate < 0) return {};
    Choice choice{table.node(best_candidate), 0.0};
    const std::vector<int> values = values_of(samples, choice.node);
    const Binning binning = binning_of(values);
    const int low = best_bin > 0 ? binning.last_value(0, best_bin - 1) : std::numeric_limits<int>::min();
    const int high = binning.last_value(0, best_bin + 1);
    std::vector<int> sorted;
    std::ranges::copy_if(values, std::back_inserter(sorted), [&](int v) { return v > low && v <= high; });
    std::ranges::sort(sorted);
    best_score = std::numeric_limits<std::int64_t>::min();
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      const int next = i + 1 < sorted.size() ? sorted[i + 1] : sorted[i] + 1;
      const std::int64_t score = score_of(samples, values, sorted[i], least);
      if (next == sorted[i] || score <= best_score) continue;
      best_score = score;
      choice.node.threshold_mm = static_cast<std::int16_t>(std::floor((sorted[i] + next) / 2.0));
    }
    const std::int64_t before = score_of(samples, values, std::numeric_limits<int>::max(), 0);
    choice.gain = static_cast<double>(best_score - before) / (1024.0 * static_cast<double>(samples.size()));
    return choice;
  }

  std::vector<int> values_of(const Samples& samples, const TreeNode& node) const {
    std::vector<int> values;
    for (const TrainingSample& sample : samples) values.push_back(feature(sample, node));
    return values;
  }

  Binning binning_of(const std::vector<int>& values) const {
    const auto [low, high] = std::ranges::minmax(values);
    ValueRanges ranges(1);
    ranges.low[0] = static_cast<std::int16_t>(low);
    ranges.high[0] = static_cast<std::int16_t>(high);
    return {ranges, bins_for(std::ssize(values), options_.split.bins)};
  }

  std::int64_t score_of(const Samples& samples, const std::vector<int>& values, int threshold, int least) const {
    const int classes = set_.class_count();
    std::vector<int> left(classes, 0), right(classes, 0);
    int n_left = 0, n_right = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      ++(values[i] <= threshold ? left : right)[samples[i].label];
      ++(values[i] <= threshold ? n_left : n_right);
    }
    if (std::min(n_left, n_right) < least) return std::numeric_limits<std::int64_t>::min();
    std::int64_t score = -entropy_(n_left) - entropy_(n_right);
    for (int c = 0; c < classes; ++c) score += entropy_(left[c]) + entropy_(right[c]);
    return score;
  }

  const TrainingSet& set_;
  const std::vector<LabelledFrame>& frames_;
  GrowTreeOptions options_;
  int tree_;
  LeafShares shares_;
  EntropyTable entropy_;
  std::vector<GrownNode> nodes_;
};

const Camera kCamera{80, 60, 66.F, 66.F, 39.5F, 29.5F};

std::vector<LabelledFrame> people(int count) {
  std::vector<LabelledFrame> frames;
  for (int i = 0; i < count; ++i) {
    CapsuleScene scene;
    CapsulePerson person;
    person.feet = {-0.3F + 0.1F * static_cast<float>(i % 7), 1.F, 2.F + 0.1F * static_cast<float>(i % 5)};
    person.pose.yaw = 0.3F * static_cast<float>(i % 5 - 2);
    person.pose.r_arm.raise = 0.3F * static_cast<float>(i % 6);
    scene.people.push_back(person);
    frames.push_back(render(scene, kCamera, paper_body()));
    for (std::size_t p = i; p < frames.back().frame.depth.size(); p += 31) {
      frames.back().frame.depth[p] = 0;  // holes
    }
  }
  return frames;
}

TrainingSet set_of(const std::vector<LabelledFrame>& frames, int pixels, std::size_t first_frame = 0) {
  SampleOptions sample;
  sample.pixels_per_frame = pixels;
  sample.held_out_share = 0.F;
  FeatureConvention convention;
  convention.clip_mm = 1000;
  TrainingSet set(paper_body(), convention, sample, 5, first_frame);
  for (const LabelledFrame& frame : frames) set.add(frame);
  return set;
}

/// Returns the tree that shards within this process grow; shard i has the frames [ends[i - 1], ends[i]).
Tree grow_over(const std::vector<std::size_t>& ends, const std::vector<LabelledFrame>& frames, const TrainingSet& whole,
               int pixels, const GrowTreeOptions& options, int tree) {
  std::vector<TrainingSet> sets;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const std::size_t begin = i > 0 ? ends[i - 1] : 0;
    sets.push_back(set_of(
        {frames.begin() + static_cast<std::ptrdiff_t>(begin), frames.begin() + static_cast<std::ptrdiff_t>(ends[i])},
        pixels, begin));
  }
  std::vector<const TrainingSet*> shards;
  for (const TrainingSet& set : sets) shards.push_back(&set);
  GrowProgress progress;
  LocalTree local(shards, options, tree);
  return grow_tree(local, whole.untrained_forest(), options, tree, progress);
}

/// Expects the obvious trainer's tree from 1, 2 and 5 shards, of which some have few frames and one has none.
void expect_obvious_tree(const std::vector<LabelledFrame>& frames, int pixels, const GrowTreeOptions& options,
                         int tree) {
  const TrainingSet set = set_of(frames, pixels);
  const Tree truth = ObviousTrainer(set, frames, options, tree).grow();
  EXPECT_GT(truth.nodes.size(), 5U);
  EXPECT_EQ(grow_tree(set, options, tree), truth);
  const std::size_t n = frames.size();
  for (const std::vector<std::size_t>& ends :
       {std::vector<std::size_t>{n}, {n / 2, n}, {1, n / 2, n / 2, n - 1, n}, {0, 1, 1, n, n}}) {
    EXPECT_EQ(grow_over(ends, frames, set, pixels, options, tree), truth) << ends.size() << " shards";
  }
}

TEST(GrowTree, AgreesWithTheObviousTrainer) {
  const std::vector<LabelledFrame> frames = people(8);
  GrowTreeOptions options;
  options.split.candidates = 12;
  options.leaf.max_depth = 7;
  options.leaf.min_samples = 6;
  expect_obvious_tree(frames, 300, options, 3);
  options.split.split_pixels = 150;  // most nodes choose from a part of their samples
  options.split.bins = 5;
  options.leaf.prior_correction = 1.F;
  expect_obvious_tree(frames, 300, options, 4);
}

TEST(GrowTree, AgreesWithTheObviousTrainerForSeveralBlocksOfCandidates) {
  const std::vector<LabelledFrame> frames = people(2);
  GrowTreeOptions options;
  options.leaf.max_depth = 4;
  options.leaf.min_samples = 6;
  options.split.candidates = kBlockCandidates + 9;
  expect_obvious_tree(frames, 150, options, 0);
  options.split.shared_features = kBlockCandidates + 20;
  options.split.split_pixels = 40;
  expect_obvious_tree(frames, 150, options, 0);
}

TEST(GrowTree, AgreesWithTheObviousTrainerIfShardsLackClasses) {
  std::vector<LabelledFrame> frames = people(6);
  const int chest = paper_body().find_part("l_chest");
  ASSERT_GE(chest, 0);
  for (int f = 0; f < 6; ++f) {  // the first frames have no background; the last has only background and a chest
    for (std::size_t p = 0; p < frames[f].labels.size(); ++p) {
      const bool background = frames[f].labels[p] == kBackground;
      if (f < 3 ? background : f == 5 && !background && frames[f].labels[p] != chest) frames[f].frame.depth[p] = 0;
    }
  }
  GrowTreeOptions options;
  options.split.candidates = 15;
  options.leaf.max_depth = 8;
  options.leaf.min_samples = 2;
  expect_obvious_tree(frames, 200, options, 2);
}

TEST(GrowTree, GrowsTheSameTreeWithLittleMemory) {
  const std::vector<LabelledFrame> frames = people(5);
  const TrainingSet set = set_of(frames, 300);
  GrowTreeOptions options;
  const Tree whole = grow_tree(set, options, 0);
  options.row_bytes = 20000;
  EXPECT_EQ(grow_tree(set, options, 0), whole);
  options.batch_bytes = 1;
  EXPECT_EQ(grow_over({2, 5}, frames, set, 300, options, 0), whole);
  options.row_bytes = options.batch_bytes = std::size_t{1} << 30U;
  EXPECT_EQ(grow_over({2, 5}, frames, set, 300, options, 0), whole);
}

TEST(GrowTree, TestsOnlySharedFeaturesIfThereAreAny) {
  const std::vector<LabelledFrame> frames = people(3);
  const TrainingSet set = set_of(frames, 300);
  GrowTreeOptions options;
  options.leaf.max_depth = 8;
  options.split.shared_features = 5;
  const CandidateTable list = node_candidates(set.convention(), options, 0, 1, 0);
  const Tree tree = grow_tree(set, options, 0);
  ASSERT_GT(tree.nodes.size(), 10U);
  for (const TreeNode& node : tree.nodes) {
    bool listed = false;
    for (int c = 0; c < list.count; ++c) {
      const TreeNode each = list.node(c);
      listed |= each.du1 == node.du1 && each.dv1 == node.dv1 && each.du2 == node.du2 && each.dv2 == node.dv2;
    }
    EXPECT_TRUE(listed);
  }
}

// Labels: threads
TEST(GrowTree, GrowsTheSameTreeOnAnyNumberOfThreads) {
  const std::vector<LabelledFrame> frames = people(10);
  const TrainingSet set = set_of(frames, 2000);  // more samples than one thread takes at a time
  std::optional<Tree> alone;
  for_threads({1, 2, 4}, [&] {
    const Tree tree = grow_tree(set, {}, 1);
    if (!alone) alone = tree;
    EXPECT_GT(tree.nodes.size(), 50U);
    EXPECT_EQ(tree, *alone);
    EXPECT_EQ(grow_over({3, 10}, frames, set, 2000, {}, 1), *alone);
  });
}

TEST(GrowTree, GivesLeavesTheSharesOfTheirSamples) {
  const std::vector<LabelledFrame> frames = people(6);
  const TrainingSet set = set_of(frames, 400);
  GrowTreeOptions options;
  options.leaf.max_depth = 5;
  options.leaf.part_balance = 0.F;
  const Tree tree = grow_tree(set, options, 0);
  std::vector<std::vector<int>> counts(tree.leaves.size(), std::vector<int>(26, 0));
  for (const TrainingSample& sample : set.samples()) {
    const Frame& frame = frames[sample.frame].frame;
    const OffsetScale scale = OffsetScaler(set.convention(), frame.camera).at(sample.depth_mm);
    const TreeLeaf& leaf = walk(tree, frame.depth, set.convention(), scale, sample.u, sample.v);
    ++counts[&leaf - tree.leaves.data()][sample.label];
  }
  for (std::size_t l = 0; l < counts.size(); ++l) {
    int total = 0;
    for (const int n : counts[l]) total += n;
    ASSERT_GE(total, options.leaf.min_samples);
    for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
      if (tree.leaves[l].probability[k] == 0) continue;
      EXPECT_EQ(tree.leaves[l].probability[k], counts[l][tree.leaves[l].label[k]] * 255 / total);
    }
  }
}

TEST(GrowTree, CountsItsProgress) {
  const std::vector<LabelledFrame> frames = people(4);
  const TrainingSet set = set_of(frames, 400);
  GrowTreeOptions options;
  options.leaf.max_depth = 6;
  GrowProgress progress;
  const Tree tree = grow_tree(set, options, 0, &progress);
  EXPECT_EQ(progress.settled, set.samples().size() * 6U);
  EXPECT_GE(progress.nodes, tree.nodes.size()) << "pruning takes some away";
  EXPECT_GT(progress.evaluations, set.samples().size() * 50U);
}

TEST(GrowTree, StopsWhenAsked) {
  const std::vector<LabelledFrame> frames = people(1);
  const TrainingSet set = set_of(frames, 400);
  GrowProgress progress;
  progress.stop = true;
  EXPECT_THROW(grow_tree(set, {}, 0, &progress), Interrupted);
}

TEST(GrowTree, RefusesSetsWithoutSamplesAndBadOptions) {
  TrainingSet empty(paper_body(), {}, {}, 1);
  EXPECT_THROW(grow_tree(empty, {}, 0), Error);
  const std::vector<LabelledFrame> frames = people(1);
  const TrainingSet set = set_of(frames, 40);
  GrowTreeOptions options;
  options.split.split_pixels = 70000;
  EXPECT_THROW(grow_tree(set, options, 0), UsageError);
}

}  // namespace
}  // namespace vesalius
