#pragma once

#include <functional>
#include <memory>

#include "dataset/open_truth.h"
#include "evaluation/evaluate_set.h"
#include "evaluation/evaluation.h"
#include "metrics/score_sequence.h"

namespace vesalius {

/// Consecutive frames that are resampled together for intervals: what one frame shows, the next ones show too.
inline constexpr int kFramesPerBlock = 30;

/// Opens the frames of a set once more, from their first on. It may be called from several threads.
using OpenTruth = std::function<std::unique_ptr<TruthSource>()>;

/// Follows the people of each recording of a set (FrameTruth::sequence) with a tracker of its own, frame after frame,
/// and judges them; `judge` says by which body and joint set. Recordings are processed in parallel, on all allowed
/// threads, each by one that opens the frames for itself and passes over those of others. The result is the same for
/// any number of threads; it has no curves, confusion or precision, which are of single frames. The hooks are called by
/// one thread at a time, and there is no total of frames. Throws Error for labels of other parts than the model's, a
/// source without frames, one whose frames stand alone, the first frame that fails (unless it is to keep going), and
/// when it is stopped.
SetResult evaluate_sequences(const OpenTruth& open, const SetOptions& options, const FrameScorer& judge,
                             const SequenceTrackerFactory& trackers, SequenceScorer::Options scored = {},
                             const EvaluationHooks& hooks = {});

}  // namespace vesalius
