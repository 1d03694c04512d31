#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eval/detection_curve.h"
#include "eval/fit_score.h"
#include "eval/joint_metrics.h"
#include "eval/joint_precision.h"
#include "eval/metric_table.h"
#include "eval/pixel_metrics.h"
#include "eval/score_frame.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/detect.h"

namespace vesalius {

/// A frame worth looking at.
struct WorstFrame {
  Frame frame;
  FrameScore score;
};

/// What a set came to with one thing of the method changed.
struct AblationRow {
  std::string variant;
  std::vector<Estimate> metrics;
  double frame_ms = 0.0;  ///< as SetResult's
};

/// What an evaluation found out about one set of frames.
struct SetResult {
  std::string name;
  std::string source;
  int frames = 0;
  int failed = 0;
  double seconds = 0.0;
  double frame_ms = 0.0;           ///< median time of the detector on a frame, all threads on it; only with an ablation
  std::vector<std::string> notes;  ///< what the source says of its frames, a line each
  std::vector<std::string> failures;  ///< the first ones, a line each
  MetricTable metrics;
  DetectionLog log;
  JointCurve joint_curve;
  JointPrecision joint_precision;
  std::optional<PixelConfusion> confusion;
  std::map<std::string, std::map<std::string, std::vector<double>>> offsets_m;  ///< [joint set][joint]
  std::vector<ScoreSample> samples;                                             ///< to fit the score on
  std::vector<WorstFrame> worst;                                                ///< the worst first
  std::vector<AblationRow> ablation;                                            ///< the same frames by each variant
};

/// A model on some sets of frames: what reports are made from.
struct Evaluation {
  std::string command;  ///< that repeats it
  std::string model;    ///< path
  std::string model_checksum;
  std::string version;  ///< of the program
  std::string machine;  ///< what timings depend on, on one line
  DetectOptions options;
  BodyModel body;
  bool labels_only = false;
  bool has_background = false;  ///< the model has a background class
  std::vector<SetResult> sets;
};

/// Number of steps of the curve over the score.
inline constexpr int kScoreSteps = 50;

}  // namespace vesalius
