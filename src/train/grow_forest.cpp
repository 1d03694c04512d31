#include "train/grow_forest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

/// Most steps to the furthest probe: what a byte holds, so that nodes take 8 bytes (packed_tree.h).
constexpr float kMostSteps = 127.F;

std::vector<Tree> grow_trees(const TrainingSet& set, const TrainOptions& options, int first, int count) {
  std::vector<Tree> trees;
  for (int t = 0; t < count; ++t) trees.push_back(grow_tree(set, options.grow, first + t));
  return trees;
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
}

void check(const TrainOptions& options) {
  TrainOptions copy = options;
  RangeCheck range;
  visit_options("", copy, range);
}

FeatureConvention training_convention(const TrainOptions& options) {
  FeatureConvention convention;
  const float furthest = options.grow.split.max_offset_m * convention.reference_focal_px;
  convention.offset_unit = std::max(convention.offset_unit, furthest / kMostSteps);
  convention.clip_mm = static_cast<std::uint16_t>(std::lround(1000.F * options.probe_clip_m));
  return convention;
}

Forest assemble_forest(const TrainingSet& set, std::vector<Tree> trees, std::string recipe) {
  Forest forest;
  forest.body = set.body();
  forest.convention = set.convention();
  forest.has_background = set.has_background();
  forest.trees = std::move(trees);
  forest.recipe = std::move(recipe);
  check(forest);
  return forest;
}

Forest grow_forest(const std::vector<LabelledFrame>& frames, const BodyModel& body, const TrainOptions& options) {
  check(options);
  if (frames.empty()) throw Error("training: no frames");
  TrainingSet set(body, training_convention(options), options.sample, static_cast<std::uint64_t>(options.grow.seed));
  for (const LabelledFrame& frame : frames) set.add(frame);
  if (options.hard_trees > 0 && set.has_background()) {
    set.add_hard_negatives(
        assemble_forest(set, grow_trees(set, options, kFirstHardTree, options.hard_trees), "first round"));
  }
  return assemble_forest(
      set, grow_trees(set, options, 0, options.trees),
      fmt::format("grow_forest: {} frames, {} pixels each, {} trees, depth {}, {} candidates, seed {}", frames.size(),
                  options.sample.pixels_per_frame, options.trees, options.grow.leaf.max_depth,
                  options.grow.split.candidates, options.grow.seed));
}

}  // namespace vesalius
