#pragma once

#include <memory>

#include "eval/score_sequence.h"
#include "vesalius/detect.h"

namespace vesalius::cli {

/// Returns what makes the trackers that `evaluate --track` measures, each for one sequence: people are detected in
/// every frame, and those whose masks overlap most with somebody's of the frame before have that one's id.
///
/// STAND-IN: to be replaced by the PeopleTracker, whose expect() gives the detector its Prior and whose update() takes
/// the people; nothing else here or in eval depends on how ids are given.
SequenceTrackerFactory sequence_trackers(std::shared_ptr<const PixelLabeller> labeller, const DetectOptions& options);

}  // namespace vesalius::cli
