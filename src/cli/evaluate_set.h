#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/progress.h"
#include "eval/score_frame.h"
#include "io/truth_source.h"

namespace vesalius::cli {

/// Of every so many frames the first serves for fitting joint offsets and is left out of the joints' figures.
inline constexpr int kFitEvery = 10;

/// A frame worth looking at.
struct WorstFrame {
  Frame frame;
  FrameScore score;
};

/// What `vesalius evaluate` found out about one source.
struct SetResult {
  std::string name;
  std::string source;
  int frames = 0;
  int failed = 0;
  double seconds = 0.0;
  std::vector<std::string> notes;
  std::vector<std::string> failures;  ///< the first ones, a line each
  FigureTable figures;
  DetectionLog log;
  JointCurve joint_curve;
  std::optional<PixelConfusion> confusion;
  std::map<std::string, std::map<std::string, std::vector<double>>> offsets_m;  ///< [joint set][joint]
  std::vector<WorstFrame> worst;                                                ///< the worst first
};

struct SetRequest {
  std::string name;
  std::string source;
  int step = 1;
  bool keep_going = false;
  std::size_t worst = 3;  ///< how many frames to keep
};

/// Scores all frames of a source on all threads allowed; what it holds does not grow with their number, but for the
/// 28 bytes of a judged proposal. Throws Error for a source that cannot be opened, for labels of other parts than the
/// model's, for the first frame that fails (unless it is to keep going) and when interrupted.
SetResult evaluate_set(const SetRequest& request, const FrameScorer& scorer, Progress& progress);

}  // namespace vesalius::cli
