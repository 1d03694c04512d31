#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "dataset/open_truth.h"
#include "evaluation/evaluation.h"
#include "metrics/score_frame.h"

namespace vesalius {

/// The first of every so many frames is for fitting joints and is left out of the joints' metrics.
inline constexpr int kFitEvery = 10;

struct SetOptions {
  std::string name;         ///< part of the frames' keys: sets compare by name
  std::string source;       ///< where the frames come from, for reports and errors
  bool keep_going = false;  ///< counts frames that fail and continues
  bool fit_joints = false;  ///< all frames are for fitting joints: keeps the people found with their truth
  std::size_t worst = 3;    ///< how many of the worst frames to keep
};

/// Functions that evaluate_set calls while it works, in its own thread. Each may be empty.
struct EvaluationHooks {
  std::function<void(int done, int total)> progress;    ///< total is -1 if it is not known
  std::function<void(const std::string& why)> failure;  ///< a frame failed and is skipped
  std::function<bool()> stop;                           ///< returning true ends the evaluation with an Error
};

/// Throws Error naming the source unless its parts, if it has any, are the body's.
void check_parts(const std::vector<std::string>& names, const BodyModel& body, const std::string& source);

/// Adds a frame to the worst ones, of which the worst is first, if something went wrong in it and it is among the
/// `most` worst.
void keep_if_worst(WorstFrame frame, std::size_t most, std::vector<WorstFrame>& worst);

/// Scores all frames of a source on all allowed threads. Its memory grows by 28 bytes for each proposal, 8 for each
/// joint of one, for fitting joints by 4 kB for each person found, but not with the frames
/// themselves. Throws Error for labels of other parts than the model's, a source without frames, the first frame that
/// fails (unless it is to keep going), and when it is stopped.
SetResult evaluate_set(TruthSource& frames, const SetOptions& options, const FrameScorer& scorer,
                       const EvaluationHooks& hooks = {});

}  // namespace vesalius
