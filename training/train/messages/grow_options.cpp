#include "train/messages/grow_options.h"

#include "train/messages/training_messages.h"

namespace vesalius {
namespace {

/// Nodes are numbered as in a heap: the root is 1, its children are 2n and 2n + 1. Numbers are unique within this
/// depth.
constexpr int kDeepest = 30;

}  // namespace

void visit_options(const std::string& prefix, GrowTreeOptions& options, OptionVisitor& visitor) {
  SplitOptions& split = options.split;
  LeafOptions& leaf = options.leaf;
  visitor.option(prefix + "depth", leaf.max_depth, {"", 0, kDeepest, "Most decisions on the way to a leaf"});
  visitor.option(prefix + "seed", options.seed, {"", 0, 2147483647, "Number that all random choices follow from"});
  visitor.option(prefix + "candidates", split.candidates, {"", 1, 100000, "Pairs of offsets that a node tries"});
  visitor.option(prefix + "shared-features", split.shared_features,
                 {"", 0, 100000, "Length of one list of pairs that all nodes try; 0: every node draws its own"});
  visitor.option(prefix + "bins", split.bins, {"", 2, 32, "Intervals that the values of a pair are counted in"});
  visitor.option(prefix + "split-pixels", split.split_pixels,
                 {"", 2, kMostCounted, "Most samples that choose the split of a node"});
  visitor.option(prefix + "max-offset", split.max_offset_m, {"m", 0.005, 10, "Furthest probe from the pixel"});
  visitor.option(prefix + "half-normal", split.half_normal,
                 {"", 0, 1, "Distances of probes half-normal, a third of the furthest being sigma; else uniform"});
  visitor.option(prefix + "one-sided", split.one_sided, {"", 0, 1, "Share of the pairs with one probe at the pixel"});
  visitor.option(prefix + "min-gain", split.min_gain, {"bits", 0, 10, "Least information that a split gains"});
  visitor.option(prefix + "min-samples", leaf.min_samples, {"", 1, 1000000, "Fewest samples of a leaf"});
  visitor.option(prefix + "prior-correction", leaf.prior_correction,
                 {"", 0, 1, "How far leaves undo what sampling did to the shares of the classes; 1: wholly"});
  visitor.option(prefix + "part-balance", leaf.part_balance,
                 {"", 0, 1, "How far leaves make up for the parts' sizes, so that small ones are seen; 1: wholly"});
}

}  // namespace vesalius
