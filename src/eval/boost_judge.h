#pragma once

#include <vector>

#include "vesalius/forest/person_judge.h"

namespace vesalius {

/// A proposal's evidence, and whether it is a person.
struct JudgeSample {
  std::vector<float> evidence;
  bool person = false;
  double weight = 1.0;
};

struct BoostOptions {
  int trees = 400;
  double rate = 0.05;           ///< share of a tree's step that is taken
  double sample_share = 0.7;    ///< of the samples that a tree sees
  double evidence_share = 0.6;  ///< of the kinds of evidence that a tree may ask for
  double ridge = 10.0;          ///< on values of leaves, in units of a sample of mean weight
  double least_weight = 5.0;    ///< smallest curvature of a leaf, in the same units
};

/// Grows trees one after the other, each by a Newton step on the logistic loss (Friedman 2001; Chen and Guestrin, 2016,
/// eq. 5 to 7). The probability can only rise with evidence of sign 1, and only fall with that of sign -1. The same
/// samples give the same judge for any number of threads. Throws Error if samples differ in length or if all are of one
/// kind.
PersonJudge boost_judge(const std::vector<JudgeSample>& samples, const std::vector<int>& signs,
                        const BoostOptions& options = {});

}  // namespace vesalius
