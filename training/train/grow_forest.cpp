#include "train/grow_forest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "train/leaves/learn_leaves.h"
#include "train/local_executor.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// Largest number of steps to the furthest probe. It fits in a byte, so nodes take 8 bytes (packed_tree.h).
constexpr float kMostSteps = 127.F;

/// Grows the trees of a round that the store lacks, and returns all of the round in order.
std::vector<Tree> grow_round(Executor& executor, const Forest& forest, const TrainOptions& options, TreeRound round,
                             TreeStore& store, TrainObserver& observer) {
  std::vector<std::optional<Tree>> trees;
  std::vector<int> missing;
  for (int t = 0; t < round.trees; ++t) {
    trees.push_back(store.load(round.first + t));
    if (!trees.back()) missing.push_back(round.first + t);
  }
  round.missing = int(missing.size());
  GrowProgress progress;
  observer.begin_round(round, progress);
  const auto take = [&](int number, Tree tree) {
    store.save(number, tree);
    observer.add_tree(tree);
    trees[number - round.first] = std::move(tree);
  };
  Forest untrained = forest;
  untrained.trees.clear();
  try {
    if (!missing.empty()) executor.grow_trees(untrained, options.grow, missing, progress, take);
  } catch (...) {
    observer.end_round();
    throw;
  }
  observer.end_round();
  std::vector<Tree> grown;
  for (std::optional<Tree>& tree : trees) grown.push_back(std::move(*tree));
  return grown;
}

/// Adds background that `forest` takes for a body as samples, at most as many as the options allow. Returns their
/// number.
std::size_t add_hard_negatives(Executor& executor, const Forest& forest, const SampleOptions& options) {
  const HardCounts hard = executor.count_hard_negatives(forest);
  const double most = double(options.hard_share) * double(hard.background);
  return executor.add_hard_negatives(hard_cut(hard, static_cast<std::uint64_t>(most)));
}

/// Learns the leaves of a forest together, and how a person's heading follows from them. Does nothing where the options
/// ask for no rounds or the forest has no background class.
void learn_all_leaves(Executor& executor, Forest& forest, const LeafLearningOptions& options, TreeStore& store,
                      TrainObserver& observer) {
  if (options.rounds == 0 || !forest.has_background) return;
  const LogitLayout layout(forest.body, forest.has_background, options.headings);
  const auto end_round = [&](int round, double likelihood) {
    return observer.end_leaf_round(round, options.rounds, likelihood);
  };
  const LeafLogits logits =
      learn_leaves(*executor.begin_leaves(forest, layout), forest, layout, options, store, end_round);
  set_logits(forest, layout, logits);
  forest.facing = fit_facing(executor.facing_samples(forest), layout.parts, layout.headings);
  check(forest);
}

}  // namespace

void visit_options(const std::string& prefix, TrainOptions& options, OptionVisitor& visitor) {
  visitor.option(prefix + "trees", options.trees, {"", 1, 256, "Trees of the forest"});
  visitor.option(prefix + "hard-trees", options.hard_trees,
                 {"", 0, 256, "Trees of a first round that looks for background taken for a body; 0: no such round"});
  visitor.option(prefix + "probe-clip", options.probe_clip_m,
                 {"m", 0, 60, "Probes read at most this much nearer or further than the pixel; 0: whatever there is"});
  visit_options(prefix, options.sample, visitor);
  visit_options(prefix, options.grow, visitor);
  visit_options(prefix, options.leaves, visitor);
}

void check(const TrainOptions& options) {
  TrainOptions copy = options;
  RangeCheck range;
  visit_options("", copy, range);
  if (options.leaves.headings != 0 && options.leaves.headings != kHeadings) {
    throw UsageError(fmt::format("leaf-headings {}, expected 0 or {}", options.leaves.headings, kHeadings));
  }
}

FeatureConvention training_convention(const TrainOptions& options) {
  FeatureConvention convention;
  const float furthest = options.grow.split.max_offset_m * convention.reference_focal_px;
  convention.offset_unit = std::max(convention.offset_unit, furthest / kMostSteps);
  convention.clip_mm = static_cast<std::uint16_t>(std::lround(1000.F * options.probe_clip_m));
  return convention;
}

Forest train_forest(Executor& executor, Forest forest, const TrainOptions& options, TreeStore& store,
                    TrainObserver& observer) {
  check(options);
  const auto grow = [&](const char* name, int first, int count) {
    forest.trees = grow_round(executor, forest, options, {name, first, count, 0}, store, observer);
    check(forest);
  };
  if (options.hard_trees > 0 && forest.has_background) {
    grow("first round", kFirstHardTree, options.hard_trees);
    observer.add_hard_negatives(add_hard_negatives(executor, forest, options.sample));
  }
  grow("forest", 0, options.trees);
  learn_all_leaves(executor, forest, options.leaves, store, observer);
  return forest;
}

Forest grow_forest(const std::vector<LabelledFrame>& frames, const BodyModel& body, const TrainOptions& options) {
  check(options);
  if (frames.empty()) throw Error("training: no frames");
  TrainingSet set(body, training_convention(options), options.sample, static_cast<std::uint64_t>(options.grow.seed));
  for (const LabelledFrame& frame : frames) set.add(frame);
  Forest forest = set.untrained_forest();
  forest.recipe = fmt::format("grow_forest: {} frames, {} pixels each, {} trees, depth {}, {} candidates, seed {}",
                              frames.size(), options.sample.pixels_per_frame, options.trees,
                              options.grow.leaf.max_depth, options.grow.split.candidates, options.grow.seed);
  LocalExecutor executor({&set});
  MemoryTreeStore store;
  TrainObserver nobody;
  return train_forest(executor, std::move(forest), options, store, nobody);
}

}  // namespace vesalius
