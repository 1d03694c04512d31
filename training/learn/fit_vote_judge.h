#pragma once

#include <vector>

#include "metrics/fit_samples.h"
#include "vesalius/body_model.h"
#include "vesalius/boosted_trees.h"

namespace vesalius {

/// Fits the judge of a labeller that votes for the middles of people: a logistic regression over a few kinds of
/// evidence and their squares, by Newton steps, written as trees that rise in steps. Rendered frames hold too few
/// wrong candidates for more: trees that are boosted on them suit real rooms less (decision 58). Throws Error unless
/// there are people and nobodies.
BoostedTrees fit_vote_judge(const std::vector<BoostSample>& samples, const BodyModel& body);

}  // namespace vesalius
