#pragma once

#include <vector>

#include "vesalius/base/frame_truth.h"
#include "vesalius/detect.h"
#include "vesalius/score_person.h"

namespace vesalius {

/// What spoke for a candidate of which it is known whether it was a person.
struct ScoreSample {
  Evidence evidence;
  bool person = false;
};

/// The candidates of a frame that can be told: each by itself, however many show the same person. A person has a mask
/// of IoU kMatchIou with a true one, or where only the mask of all people is known, kShareOnMask of its pixels there or
/// of that mask's among its own; nobody less than half of either, and less than half of kShareOnMask on people, or is
/// in a frame without people. What lies between is left out, and so are frames with people of whose masks nothing is
/// known.
std::vector<ScoreSample> score_samples(const Trace& trace, const FrameTruth& truth, const DepthImage& depth);

struct ScoreFit {
  ScoreOptions options;
  long people = 0;
  long nobodies = 0;
  double area_before = 0.0;  ///< share of pairs of a person and a nobody that the score puts in order, 0-1
  double area_after = 0.0;
};

/// Weights and bias of the person score by logistic regression, so that 0.5 lies between people and nobodies; the
/// other options are those of `start`. The people of every set weigh the same together, and so do its nobodies: a long
/// sequence does not drown a short one. Weights are held towards 0 a little, for sets that a line parts wholly.
/// Throws Error where there are no people or no nobodies.
ScoreFit fit_score(const std::vector<std::vector<ScoreSample>>& sets, const ScoreOptions& start);

}  // namespace vesalius
