#pragma once

#include <cstddef>
#include <string>

#include "vesalius/base/options.h"

namespace vesalius {

/// Options of how the splits of a tree are proposed and judged.
struct SplitOptions {
  int candidates = 64;        ///< number of pairs of offsets that a node tries
  int bins = 32;              ///< intervals in which a candidate's values are counted, 2 to 32
  int split_pixels = 20000;   ///< most samples of a node from which its split is chosen
  float max_offset_m = 1.5F;  ///< furthest probe; at reference focal length 1
  bool half_normal = true;    ///< distances of probes are half-normal with sigma max_offset_m / 3; else uniform
  float one_sided = 0.75F;    ///< share of the pairs with one probe at the pixel itself
  int shared_features = 0;    ///< if > 0, all nodes try one list of so many pairs (the paper: 2000)
  float min_gain = 1e-3F;     ///< bits per sample; a node whose best split gains less is a leaf
};

/// Options of when a node becomes a leaf, and of the leaf's shares.
struct LeafOptions {
  int max_depth = 20;            ///< decisions on the way to the deepest leaf
  int min_samples = 30;          ///< fewest samples of a leaf
  float prior_correction = 0.F;  ///< 0 leaves shares as sampled, 1 gives those of the pictures; powers between
  float part_balance = 0.5F;     ///< likewise towards equal shares of all parts; the background keeps its own
};

struct GrowTreeOptions {
  int seed = 1;
  SplitOptions split;
  LeafOptions leaf;
  /// Limits in bytes on the feature values held at a time, and on the values and histograms of a batch of nodes, which
  /// stay in the second-level cache. The tree does not depend on either.
  std::size_t row_bytes = std::size_t{512} << 20U;
  std::size_t batch_bytes = std::size_t{256} << 10U;
};
void visit_options(const std::string& prefix, GrowTreeOptions& options, OptionVisitor& visitor);

}  // namespace vesalius
