#pragma once

#include <vector>

#include "vesalius/forest/person_judge.h"

namespace vesalius {

/// A proposal's evidence, and whether it is a person.
struct JudgeSample {
  std::vector<float> evidence;
  bool person = false;
};

struct BoostOptions {
  int trees = 1600;
  double rate = 0.03;           ///< share of a tree's step that is taken
  double sample_share = 0.7;    ///< of the samples that a tree sees
  double evidence_share = 0.6;  ///< of the kinds of evidence that a tree may ask for
  double ridge = 10.0;          ///< on values of leaves, in samples
  int least_samples = 60;       ///< fewest samples of a leaf: of fewer, rooms are learned by heart
};

/// Grows trees one after the other, each by a Newton step on the logistic loss (Friedman 2001; Chen and Guestrin, 2016,
/// eq. 5 to 7). The probability can only rise with evidence of sign 1, and only fall with that of sign -1. The same
/// samples give the same judge for any number of threads. Throws Error if samples differ in length or if all are of one
/// kind.
PersonJudge boost_judge(const std::vector<JudgeSample>& samples, const std::vector<int>& signs,
                        const BoostOptions& options = {});

}  // namespace vesalius
