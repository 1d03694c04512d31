#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "dataset/truth_source.h"
#include "eval/ablation_variants.h"
#include "eval/score_frame.h"
#include "evaluation/evaluation.h"

namespace vesalius {

/// Of every so many frames the first serves for fitting joint offsets and is left out of the joints' metrics.
inline constexpr int kFitEvery = 10;

struct SetOptions {
  std::string name;         ///< part of the frames' keys: sets compare by name
  std::string source;       ///< where the frames come from, for reports and errors
  bool keep_going = false;  ///< frames that fail are counted and passed over
  std::size_t worst = 3;    ///< how many of the worst frames to keep
};

/// Calls of evaluate_set while it works, from the thread that it runs on. Each may be empty.
struct EvaluationHooks {
  std::function<void(int done, int total)> progress;    ///< total is -1 where it is not known
  std::function<void(const std::string& why)> failure;  ///< a frame failed and is passed over
  std::function<bool()> stop;                           ///< true ends the evaluation with an Error
};

/// Scores all frames of a source on all threads allowed. Its memory grows by 28 bytes for each proposal, 8 for each
/// joint of one and 20 for each sample, and not with the frames themselves. With `variants` frames come one after the
/// other, each through `scorer` and all variants in turn, and are timed: times of one frame compare even where the
/// machine's pace changes. Throws Error for labels of other parts than the model's, a source without frames, the first
/// frame that fails (unless it is to keep going), and when it is stopped.
SetResult evaluate_set(TruthSource& frames, const SetOptions& options, const FrameScorer& scorer,
                       const std::vector<Variant>& variants = {}, const EvaluationHooks& hooks = {});

}  // namespace vesalius
