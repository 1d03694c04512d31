#include "train/estimate_training.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "train/local_executor.h"
#include "train/samples/walk_samples.h"
#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"

namespace vesalius {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPilotSamples = 400000.0;   ///< enough for some seconds and more frames than caches hold
constexpr double kLargestPilotShare = 0.25;  ///< largest share of the real run
constexpr int kFirstPilotTree = 2000;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Pilot {
  TrainingSet set;
  TrainOptions options;  ///< options of the run, with less memory for rows
  double scale = 1.0;    ///< samples of the run for each sample of the pilot
};

Pilot make_pilot(const std::vector<LabelledFrame>& frames, const BodyModel& body, double samples,
                 const TrainOptions& options) {
  TrainOptions own = options;
  own.sample.held_out_share = 0.F;
  Pilot pilot{TrainingSet(body, training_convention(own), own.sample, static_cast<std::uint64_t>(own.grow.seed)), own,
              1.0};
  const double wanted = std::min(kPilotSamples, samples * kLargestPilotShare);
  const std::size_t most = frames.size() * 1000;  // otherwise frames without samples would never end
  for (std::size_t i = 0; i < most && static_cast<double>(pilot.set.samples().size()) < wanted; ++i) {
    pilot.set.add(frames[i % frames.size()]);
  }
  if (pilot.set.samples().empty()) throw Error("training: no pixel with a label and a reading in the first frames");
  pilot.scale = std::max(1.0, samples / static_cast<double>(pilot.set.samples().size()));
  // The pilot takes as many samples of a frame at a time as the run, so that unpacking has the same weight.
  pilot.options.grow.row_bytes = static_cast<std::size_t>(static_cast<double>(options.grow.row_bytes) / pilot.scale);
  return pilot;
}

/// The number of samples that one tree evaluates for each candidate, in the pilot and in the run.
struct TreeWork {
  double pilot = 0.0;
  double run = 0.0;
};

/// The samples at each node and leaf, and their levels.
struct TreeShape {
  std::vector<double> leaves, nodes;
  std::vector<int> leaf_level, node_level;
};

TreeShape shape_of(const Tree& tree, const TrainingSet& set) {
  TreeShape shape{std::vector<double>(tree.leaves.size(), 0.0), std::vector<double>(tree.nodes.size(), 0.0),
                  std::vector<int>(tree.leaves.size(), 0), std::vector<int>(tree.nodes.size(), 0)};
  for (const TrainingSample& sample : set.samples()) shape.leaves[leaf_of(tree, set.frames(), sample)] += 1.0;
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    for (const std::int32_t child : {tree.nodes[n].left, tree.nodes[n].right}) {
      (child >= 0 ? shape.node_level[child] : shape.leaf_level[~child]) = shape.node_level[n] + 1;
    }
  }
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {  // children come after their parent
    for (const std::int32_t child : {tree.nodes[n].left, tree.nodes[n].right}) {
      shape.nodes[n] += child >= 0 ? shape.nodes[child] : shape.leaves[~child];
    }
  }
  return shape;
}

/// Returns the number of levels in which the pilot halves the samples of a node, averaged over samples, since splits
/// are not even.
double levels_per_halving(const TreeShape& shape, double samples) {
  double levels = 0.0, halvings = 0.0;
  for (std::size_t l = 0; l < shape.leaves.size(); ++l) {
    if (shape.leaves[l] <= 0.0) continue;
    levels += shape.leaves[l] * shape.leaf_level[l];
    halvings += shape.leaves[l] * std::log2(samples / shape.leaves[l]);
  }
  return halvings > 0.0 ? levels / halvings : 1.0;
}

/// Estimates the work of the run's tree from the pilot's. Nodes with equally many samples cost the same and split alike
/// in both. The run has more of them, and they are deeper by the levels that lead to them; some would be below the
/// deepest level. Nodes above look at no more samples than `split_pixels`, so each level there costs the same in pilot
/// and run.
TreeWork work_of(const Tree& tree, const Pilot& pilot) {
  const TreeShape shape = shape_of(tree, pilot.set);
  const GrowTreeOptions& grow = pilot.options.grow;
  const double deeper =
      std::log2(pilot.scale) * levels_per_halving(shape, static_cast<double>(pilot.set.samples().size()));
  TreeWork work;
  for (std::size_t n = 0; n < shape.nodes.size(); ++n) {
    const double looked_at = std::min(shape.nodes[n], static_cast<double>(grow.split.split_pixels));
    work.pilot += looked_at;
    work.run += looked_at * pilot.scale * std::clamp(grow.leaf.max_depth - shape.node_level[n] - deeper, 0.0, 1.0);
  }
  return work;
}

}  // namespace

GrowthEstimate estimate_growth(const std::vector<LabelledFrame>& frames, const BodyModel& body, std::uint64_t samples,
                               const TrainOptions& options, int trees_at_once) {
  Pilot pilot = make_pilot(frames, body, static_cast<double>(samples), options);
  GrowProgress progress;
  std::vector<Tree> trees(trees_at_once);
  const Clock::time_point start = Clock::now();
  parallel_for(trees_at_once,
               [&](int t) { trees[t] = grow_tree(pilot.set, pilot.options.grow, kFirstPilotTree + t, &progress); });
  GrowthEstimate estimate;
  const auto done = static_cast<double>(progress.evaluations);
  estimate.evaluations_per_s = done / seconds_since(start);
  const TreeWork work = work_of(trees.front(), pilot);
  const double of_a_tree = work.pilot > 0.0 ? done / trees_at_once * work.run / work.pilot : done / trees_at_once;
  estimate.evaluations = of_a_tree * options.trees;
  if (options.hard_trees == 0 || !pilot.set.has_background()) return estimate;

  const auto before = static_cast<double>(pilot.set.samples().size());
  Forest forest = pilot.set.untrained_forest();
  forest.trees.push_back(std::move(trees.front()));
  LocalExecutor executor({&pilot.set});
  const Clock::time_point search_start = Clock::now();
  const auto added = static_cast<double>(add_hard_negatives(executor, forest, options.sample));
  estimate.hard_search_s = seconds_since(search_start) * pilot.scale * options.hard_trees;
  estimate.evaluations *= 1.0 + added / before;
  estimate.evaluations += of_a_tree * options.hard_trees;
  return estimate;
}

}  // namespace vesalius
