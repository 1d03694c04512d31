#pragma once

#include <cstddef>
#include <string>

#include "vesalius/base/options.h"

namespace vesalius {

/// How the splits of a tree are proposed and judged.
struct SplitOptions {
  int candidates = 64;        ///< pairs of offsets a node tries
  int bins = 32;              ///< intervals between thresholds that a candidate's values are counted in; 2 to 32
  int split_pixels = 20000;   ///< most samples of a node that the choice of its split looks at
  float max_offset_m = 1.5F;  ///< furthest probe; at reference focal length 1
  bool half_normal = true;    ///< distance of a probe half-normal, a third of `max_offset_m` as sigma; else uniform
  float one_sided = 0.75F;    ///< share of the pairs with one probe at the pixel itself
  int shared_features = 0;    ///< > 0: all nodes try this one list of pairs (the paper: 2000), not `candidates` each
  float min_gain = 1e-3F;     ///< bits a sample; a node whose best split gains less is a leaf
};

/// When a node is a leaf, and what a leaf says.
struct LeafOptions {
  int max_depth = 20;            ///< decisions on the way to the deepest leaf
  int min_samples = 30;          ///< fewest samples of a leaf
  float prior_correction = 0.F;  ///< 0: shares as sampled; 1: as in the pictures; between: a power between
  float part_balance = 0.5F;     ///< the same towards equal shares of all parts; the background keeps its own
};

struct GrowTreeOptions {
  int seed = 1;
  SplitOptions split;
  LeafOptions leaf;
  /// Most bytes of feature values held at a time, and most bytes of values and histograms of a batch of nodes, which
  /// stay in the second-level cache. The tree does not depend on either.
  std::size_t row_bytes = std::size_t{512} << 20U;
  std::size_t batch_bytes = std::size_t{256} << 10U;
};
void visit_options(const std::string& prefix, GrowTreeOptions& options, OptionVisitor& visitor);

}  // namespace vesalius
