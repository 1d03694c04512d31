#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dataset/open_truth.h"
#include "metrics/fit_samples.h"
#include "metrics/joint_metrics.h"
#include "metrics/metric_table.h"
#include "metrics/people_metrics.h"
#include "metrics/pixel_metrics.h"
#include "metrics/score_frame.h"
#include "metrics/score_sequence.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/people_options.h"

namespace vesalius {

/// A frame that is shown in the report.
struct WorstFrame {
  Frame frame;
  FrameScore score;
};

/// The results of an evaluation on one set of frames.
struct SetResult {
  std::string name;
  std::string source;
  int frames = 0;
  int failed = 0;
  double seconds = 0.0;
  std::vector<std::string> notes;     ///< remarks of the source on its frames, one line each
  std::vector<std::string> failures;  ///< the first failures, one line each
  MetricTable metrics;
  DetectionLog log;
  JointPrecision joint_precision;
  JointPrecision centre_precision;
  std::optional<PixelConfusion> confusion;
  std::vector<KnownPerson> known_people;          ///< for fitting joints
  std::vector<TrustSample> trust_samples = {};    ///< for fitting the trust in fitted joints
  std::vector<StanceSample> stance_samples = {};  ///< for fitting the stances
  std::vector<WorstFrame> worst;                  ///< the worst first
};

/// The results of a model on some sets of frames, from which reports are made.
struct Evaluation {
  std::string command;  ///< command that repeats the evaluation
  std::string model;    ///< path
  std::string model_checksum;
  std::string version;    ///< version of the program
  std::string machine;    ///< facts about the machine that timings depend on, on one line
  PeopleOptions options;  ///< those of tracking and fitted bodies count only where people were followed
  BodyModel body;
  bool labels_only = false;
  bool tracked = false;  ///< people were followed over recordings (evaluate_sequences)
  std::vector<SetResult> sets;
};

/// Number of steps of the curve over the score.
inline constexpr int kScoreSteps = 50;

struct SetOptions {
  std::string name;         ///< part of the frames' keys: sets compare by name
  std::string source;       ///< where the frames come from, for reports and errors
  bool keep_going = false;  ///< counts frames that fail and continues
  bool fit_joints = false;  ///< all frames are for fitting joints: keeps the people found with their truth
};

/// Functions that evaluate_set calls while it works, in its own thread. Each may be empty.
struct EvaluationHooks {
  std::function<void(int done, int total)> progress;    ///< total is -1 if it is not known
  std::function<void(const std::string& why)> failure;  ///< a frame failed and is skipped
  std::function<bool()> stop;                           ///< returning true ends the evaluation with an Error
};

/// Scores all frames of a source on all allowed threads. Its memory grows by 28 bytes for each proposal, 8 for each
/// joint of one, for fitting joints by 4 kB for each person found, but not with the frames themselves. The first of
/// every ten frames is left out of the joints' metrics: joints may be fitted to those. Throws Error for labels of other
/// parts than the model's, a source without frames, the first frame that fails (unless it is to keep going), and when
/// it is stopped.
SetResult evaluate_set(TruthSource& frames, const SetOptions& options, const FrameScorer& scorer,
                       const EvaluationHooks& hooks = {});

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

/// Returns what makes the trackers that `evaluate --track` measures, each for one sequence, as `detect --track` does
/// it.
SequenceTrackerFactory sequence_trackers(Model model, const PeopleOptions& options);

}  // namespace vesalius
