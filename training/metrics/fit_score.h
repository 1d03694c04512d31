#pragma once

#include <vector>

#include "vesalius/base/frame_truth.h"
#include "vesalius/detect.h"
#include "vesalius/score_person.h"

namespace vesalius {

/// The evidence for a candidate, and whether it is a person.
struct ScoreSample {
  Evidence evidence;
  bool person = false;
};

/// Returns the candidates of a frame of which the truth tells whether they are people. Each is judged by itself,
/// however many show the same person. A candidate is a person if its mask has an IoU of at least kMatchIou with a true
/// one. Where only the mask of all people is known, kShareOnMask of its pixels must lie there, or that share of the
/// mask on it. A candidate is nobody if it has less than half of this and less than half of kShareOnMask on people, or
/// if the frame is empty. All others are left out, and so are frames with people of whose masks nothing is known.
std::vector<ScoreSample> score_samples(const Trace& trace, const FrameTruth& truth, const DepthImage& depth);

struct ScoreFit {
  ScoreOptions options;
  long people = 0;
  long nobodies = 0;
  double area_before = 0.0;  ///< share of pairs of a person and a nobody that the score puts in order, 0-1
  double area_after = 0.0;
};

/// Fits weights and bias of the person score by logistic regression. All other options are those of `start`. The people
/// of every set have the same total weight, and so have its nobodies, so a long sequence does not outweigh a short one;
/// the score is the probability of a person where both are equally common. A small ridge keeps the weights finite for
/// sets that a line separates completely. Evidence whose weight would contradict its sign (EvidenceWeight) gets none.
/// Throws Error if there are no people or no nobodies.
ScoreFit fit_score(const std::vector<std::vector<ScoreSample>>& sets, const ScoreOptions& start);

}  // namespace vesalius
