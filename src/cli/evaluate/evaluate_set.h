#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/evaluate/ablation.h"
#include "cli/evaluate/truth_recipe.h"
#include "cli/progress.h"
#include "dataset/truth_source.h"
#include "eval/score_frame.h"

namespace vesalius::cli {

/// Of every so many frames the first serves for fitting joint offsets and is left out of the joints' figures.
inline constexpr int kFitEvery = 10;

/// A frame worth looking at.
struct WorstFrame {
  Frame frame;
  FrameScore score;
};

/// What a source came to with one thing of the method changed.
struct AblationRow {
  std::string variant;
  std::vector<Estimate> figures;
  double frame_ms = 0.0;  ///< as SetResult's
};

/// What `vesalius evaluate` found out about one source.
struct SetResult {
  std::string name;
  std::string source;
  int frames = 0;
  int failed = 0;
  double seconds = 0.0;
  double frame_ms = 0.0;  ///< median time of the detector on a frame, all threads on it; only with variants
  std::vector<std::string> notes;
  std::vector<std::string> failures;  ///< the first ones, a line each
  FigureTable figures;
  DetectionLog log;
  JointCurve joint_curve;
  JointPrecision joint_precision;
  std::optional<PixelConfusion> confusion;
  std::map<std::string, std::map<std::string, std::vector<double>>> offsets_m;  ///< [joint set][joint]
  std::vector<ScoreSample> samples;                                             ///< to fit the score on
  std::vector<WorstFrame> worst;                                                ///< the worst first
  std::vector<AblationRow> ablation;                                            ///< the same frames by each variant
};

struct SetRequest {
  std::string name;
  std::string source;
  int step = 1;
  bool keep_going = false;
  std::size_t worst = 3;                  ///< how many frames to keep
  std::optional<RenderedTruth> rendered;  ///< the source is a recipe, not frames
};

/// Scores all frames of a source on all threads allowed; what it holds does not grow with their number, but for the
/// 28 bytes of a judged proposal, the 8 of each of its joints and the 20 of a sample. With `variants` frames come one
/// after the other, each through `scorer` and all variants in turn, and are timed (4 bytes each): times of one frame
/// compare even where the machine's pace changes. Throws Error for a source that cannot be opened, for labels of other
/// parts than the model's, for the first frame that fails (unless it is to keep going) and when interrupted.
SetResult evaluate_set(const SetRequest& request, const FrameScorer& scorer, const std::vector<Variant>& variants,
                       Progress& progress);

}  // namespace vesalius::cli
