#pragma once

#include <vector>

#include "metrics/fit_samples.h"
#include "vesalius/body_model.h"
#include "vesalius/boosted_trees.h"

namespace vesalius {

struct BoostOptions {
  int trees = 1600;
  double rate = 0.03;          ///< share of a tree's step that is taken
  double sample_share = 0.7;   ///< share of the samples that a tree sees
  double feature_share = 0.6;  ///< share of the features that a tree may ask for
  double ridge = 10.0;         ///< on values of leaves, in samples
  int least_samples = 60;      ///< fewest samples of a leaf: of fewer, rooms are learned by heart
};

/// Grows trees one after the other, each by a Newton step on the logistic loss (Friedman 2001; Chen and Guestrin, 2016,
/// eq. 5 to 7). The probability can only rise with features of sign 1, and only fall with those of sign -1. The same
/// samples give the same trees for any number of threads. Throws Error if samples differ in length or if all are of one
/// kind.
BoostedTrees boost_trees(const std::vector<BoostSample>& samples, const std::vector<int>& signs,
                         const BoostOptions& options = {});

/// Fits the context of bodies to the cells of frames that the forest did not learn from (context_samples): which pixels
/// are bodies, by what is around them. Each cell counts the same. Throws Error unless there are cells of people and
/// others.
BoostedTrees fit_context(const std::vector<BoostSample>& samples, const BodyModel& body);

/// Throws Error unless there are candidates (judge_samples) that are people and others that are nobody.
void expect_people_and_nobodies(const std::vector<BoostSample>& samples);

/// Fits the judge to candidates (judge_samples): which of them are people, by the evidence for them. Each candidate
/// counts the same. Throws Error unless there are people and nobodies.
BoostedTrees fit_judge(const std::vector<BoostSample>& samples, const BodyModel& body);

}  // namespace vesalius
