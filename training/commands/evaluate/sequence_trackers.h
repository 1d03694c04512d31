#pragma once

#include <memory>

#include "metrics/score_sequence.h"
#include "vesalius/detect.h"
#include "vesalius/track_people.h"

namespace vesalius::cli {

/// Returns what makes the trackers that `evaluate --track` measures, each for one sequence, as `detect --track` does
/// it.
SequenceTrackerFactory sequence_trackers(Model model, const PeopleOptions& options);

}  // namespace vesalius::cli
