#pragma once

#include <vector>

#include "learn/boost_trees.h"
#include "vesalius/body_model.h"

namespace vesalius {

/// Fits the context of bodies to the cells of frames that the forest did not learn from (context_samples): which pixels
/// are bodies, by what is around them. Each cell counts the same. Throws Error unless there are cells of people and
/// others.
BoostedTrees fit_context(const std::vector<BoostSample>& samples, const BodyModel& body);

/// Fits the judge to candidates (judge_samples): which of them are people, by the evidence for them. Each candidate
/// counts the same. Throws Error unless there are people and nobodies.
BoostedTrees fit_judge(const std::vector<BoostSample>& samples, const BodyModel& body);

}  // namespace vesalius
