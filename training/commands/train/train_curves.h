#pragma once

#include <vector>

#include "commands/train/train_inputs.h"
#include "commands/train/train_report.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// Size of the smaller sets that train_curves() holds beside the main one, as a share of its frames.
inline constexpr double kCurveFrames = 0.25;

/// Trains forests of two trees without hard negatives: on 1/16, 1/4 and all frames, and with 1/4, 1 and 4 times the
/// candidates. All are measured on the held-out samples of `set`, from whose frames none of them learns. `set` holds
/// all frames of `inputs` after `backgrounds` frames. Throws Error when the user interrupts.
std::vector<CurvePoint> train_curves(const TrainInputs& inputs, const TrainingSet& set, std::size_t backgrounds,
                                     const TrainOptions& options, bool shown);

}  // namespace vesalius::cli
