#include "train/grow_forest.h"

#include <algorithm>
#include <numeric>

#include "vesalius/error.h"
#include "vesalius/parallel.h"
#include "vesalius/random.h"

namespace vesalius {
namespace {

/// Nodes are numbered as in a heap, root 1, children 2n and 2n + 1: no number repeats within this depth.
constexpr int kDeepest = 30;

class TreeGrower {
 public:
  TreeGrower(const std::vector<LabelledFrame>& frames, const FeatureConvention& convention, int classes,
             const GrowForestOptions& options, std::uint64_t tree_index, std::size_t pixels)
      : frames_(frames),
        convention_(convention),
        classes_(classes),
        options_(options),
        tree_index_(tree_index),
        entropy_(pixels) {}

  Tree grow(std::vector<TrainingPixel> pixels) {
    grow_node(pixels, 1, 0);
    return std::move(tree_);
  }

 private:
  /// Adds the subtree over these pixels; returns how its parent refers to it.
  std::int32_t grow_node(std::span<TrainingPixel> pixels, std::uint64_t number, int depth) {
    const Split split = find_split(pixels, number, depth);
    if (split.gain <= 0.0) {
      tree_.leaves.push_back(make_leaf(pixels, classes_));
      return ~static_cast<std::int32_t>(tree_.leaves.size() - 1);
    }
    const std::size_t at = tree_.nodes.size();
    tree_.nodes.push_back(split.node);
    // Stable: pixels stay ordered by frame, so that neighbours in memory read the same picture.
    const auto right = std::stable_partition(pixels.begin(), pixels.end(), [&](const TrainingPixel& pixel) {
      return feature_of(pixel, frames_, convention_, split.node) <= split.node.threshold_mm;
    });
    const auto left_size = static_cast<std::size_t>(right - pixels.begin());
    const std::int32_t left_child = grow_node(pixels.first(left_size), 2 * number, depth + 1);
    const std::int32_t right_child = grow_node(pixels.subspan(left_size), 2 * number + 1, depth + 1);
    tree_.nodes[at].left = left_child;
    tree_.nodes[at].right = right_child;
    return static_cast<std::int32_t>(at);
  }

  Split find_split(std::span<const TrainingPixel> pixels, std::uint64_t number, int depth) const {
    if (depth >= options_.max_depth) return {};
    if (std::ssize(pixels) < 2 * options_.split.min_leaf_pixels) return {};
    Random random(static_cast<std::uint64_t>(options_.seed), (tree_index_ << 32U) | number);
    return best_split(pixels, frames_, convention_, classes_, options_.split, entropy_, random);
  }

  const std::vector<LabelledFrame>& frames_;
  const FeatureConvention& convention_;
  int classes_;
  const GrowForestOptions& options_;
  std::uint64_t tree_index_;
  EntropyTable entropy_;
  Tree tree_;
};

Tree grow_tree(const std::vector<LabelledFrame>& frames, const Forest& forest, const GrowForestOptions& options,
               std::uint64_t tree) {
  std::vector<TrainingPixel> pixels = sample_pixels(frames, forest.body, forest.convention, options.sample,
                                                    static_cast<std::uint64_t>(options.seed), tree);
  if (pixels.empty()) throw Error("training: no pixel with a label and a reading in any frame");
  TreeGrower grower(frames, forest.convention, forest.class_count(), options, tree, pixels.size());
  return grower.grow(std::move(pixels));
}

std::string describe(const std::vector<LabelledFrame>& frames, const GrowForestOptions& options) {
  return "grow_forest: " + std::to_string(frames.size()) + " frames, " +
         std::to_string(options.sample.pixels_per_frame) + " pixels each, " + std::to_string(options.trees) +
         " trees, depth " + std::to_string(options.max_depth) + ", " + std::to_string(options.split.candidates) +
         " candidates, seed " + std::to_string(options.seed);
}

}  // namespace

void visit_options(const std::string& prefix, GrowForestOptions& options, OptionVisitor& visitor) {
  visitor.option(prefix + "trees", options.trees, {"", 1, 256, "Trees of the forest"});
  visitor.option(prefix + "max-depth", options.max_depth, {"", 0, kDeepest, "Most decisions on the way to a leaf"});
  visitor.option(prefix + "seed", options.seed, {"", 0, 2147483647, "Number that all random choices follow from"});
  visitor.option(prefix + "pixels", options.sample.pixels_per_frame,
                 {"", 1, 100000, "Pixels that a tree draws from each frame"});
  visitor.option(prefix + "background-share", options.sample.background_share,
                 {"", 0, 1, "Share of the pixels that lie outside all people; 0 trains without background class"});
  visitor.option(prefix + "near-share", options.sample.near_share,
                 {"", 0, 1, "Share of the background pixels that lie beside a person"});
  visitor.option(prefix + "near-distance", options.sample.near_px,
                 {"pixels", 1, 10000, "What counts as beside a person"});
  visitor.option(prefix + "balanced-share", options.sample.balanced_share,
                 {"", 0, 1, "Share of the body pixels for which every part in view counts alike"});
  visitor.option(prefix + "candidates", options.split.candidates,
                 {"", 1, 100000, "Pairs of offsets that a node tries"});
  visitor.option(prefix + "thresholds", options.split.thresholds, {"", 1, 10000, "Thresholds tried for each pair"});
  visitor.option(prefix + "max-offset", options.split.max_offset_m, {"m", 0.005, 10, "Furthest probe from the pixel"});
  visitor.option(prefix + "min-leaf-pixels", options.split.min_leaf_pixels,
                 {"", 1, 1000000, "Fewest training pixels of a leaf"});
}

FeatureConvention training_convention() {
  FeatureConvention convention;
  convention.clip_mm = 1000;
  return convention;
}

TreeLeaf make_leaf(std::span<const TrainingPixel> pixels, int classes) {
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(classes), 0);
  for (const TrainingPixel& pixel : pixels) ++counts[pixel.label];
  std::vector<std::size_t> order(counts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
  TreeLeaf leaf;
  for (std::size_t k = 0; k < std::min<std::size_t>(TreeLeaf::kClasses, order.size()); ++k) {
    const std::uint64_t share = counts[order[k]] * 255 / pixels.size();
    if (share == 0) break;
    leaf.label[k] = static_cast<std::uint8_t>(order[k]);
    leaf.probability[k] = static_cast<std::uint8_t>(share);
  }
  return leaf;
}

Forest grow_forest(const std::vector<LabelledFrame>& frames, const BodyModel& body, const GrowForestOptions& options) {
  GrowForestOptions checked = options;
  RangeCheck range;
  visit_options("", checked, range);
  if (frames.empty()) throw Error("training: no frames");
  if (body.parts.empty() || body.part_count() >= kBackground) {
    throw Error("training: body with " + std::to_string(body.part_count()) + " parts, expected 1 to 254");
  }
  Forest forest;
  forest.body = body;
  forest.convention = training_convention();
  forest.has_background = options.sample.background_share > 0.F;
  forest.recipe = describe(frames, options);
  forest.trees.resize(static_cast<std::size_t>(options.trees));
  parallel_for(options.trees, [&](int t) {
    forest.trees[static_cast<std::size_t>(t)] = grow_tree(frames, forest, options, static_cast<std::uint64_t>(t));
  });
  check(forest);
  return forest;
}

}  // namespace vesalius
