#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "train/best_split.h"
#include "train/sample_pixels.h"
#include "vesalius/body_model.h"
#include "vesalius/forest.h"
#include "vesalius/frame.h"
#include "vesalius/options.h"

namespace vesalius {

struct GrowForestOptions {
  int trees = 4;
  int max_depth = 14;
  int seed = 1;
  SampleOptions sample;
  SplitOptions split;
};
void visit_options(const std::string& prefix, GrowForestOptions& options, OptionVisitor& visitor);

/// Probes within 1 m of the pixel's depth, holes and the world outside the picture far.
FeatureConvention training_convention();

/// Class shares of a leaf: the four largest (the lower label on a tie), in 1/255, rounded down.
TreeLeaf make_leaf(std::span<const TrainingPixel> pixels, int classes);

/// Trains a forest (section 4.2): each tree draws pixels of its own; each node takes the pair of offsets and the
/// threshold that gain most information about the label. With a background class unless `background_share` is 0.
/// One tree per thread; the same forest for any number of threads, since every node draws from a generator of its own,
/// seeded by (seed, tree, node). Throws Error for unusable frames, UsageError for an option outside its range.
Forest grow_forest(const std::vector<LabelledFrame>& frames, const BodyModel& body, const GrowForestOptions& options);

}  // namespace vesalius
