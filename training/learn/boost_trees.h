#pragma once

#include <vector>

#include "metrics/fit_samples.h"
#include "vesalius/boosted_trees.h"

namespace vesalius {

struct BoostOptions {
  int trees = 1600;
  double rate = 0.03;          ///< share of a tree's step that is taken
  double sample_share = 0.7;   ///< of the samples that a tree sees
  double feature_share = 0.6;  ///< of the features that a tree may ask for
  double ridge = 10.0;         ///< on values of leaves, in samples
  int least_samples = 60;      ///< fewest samples of a leaf: of fewer, rooms are learned by heart
};

/// Grows trees one after the other, each by a Newton step on the logistic loss (Friedman 2001; Chen and Guestrin, 2016,
/// eq. 5 to 7). The probability can only rise with features of sign 1, and only fall with those of sign -1. The same
/// samples give the same trees for any number of threads. Throws Error if samples differ in length or if all are of one
/// kind.
BoostedTrees boost_trees(const std::vector<BoostSample>& samples, const std::vector<int>& signs,
                         const BoostOptions& options = {});

}  // namespace vesalius
