#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "metrics/detection_curve.h"
#include "metrics/fit_samples.h"
#include "metrics/joint_precision.h"
#include "metrics/metric_table.h"
#include "metrics/pixel_metrics.h"
#include "metrics/score_frame.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/track_people.h"

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

}  // namespace vesalius
