#pragma once

#include <vector>

#include "metrics/fit_samples.h"
#include "metrics/frame_truth.h"
#include "vesalius/detect.h"
#include "vesalius/trace.h"

namespace vesalius {

/// Returns the evidence (judge_features) for the candidates of a frame of which the truth tells whether they are
/// people. Each is judged by itself, however many show the same person. A candidate is a person if its mask has an IoU
/// of at least kMatchIou with a true one. Where only the mask of all people is known, kShareOnMask of its pixels must
/// lie there, or that share of the mask on it. A candidate is nobody if it has less than half of this and less than
/// half of kShareOnMask on people, or if the frame is empty. All others are left out, and so are frames with people of
/// whose masks nothing is known.
std::vector<BoostSample> judge_samples(const Trace& trace, const FrameTruth& truth, const DepthImage& depth);

}  // namespace vesalius
