#pragma once

#include <vector>

#include "eval/people_metrics.h"

namespace vesalius {

/// One proposal of one frame, judged.
struct JudgedProposal {
  float score = 0.F;
  int parts = 0;  ///< observed
  bool person = false;
  PartCounts counts;  ///< against the person it shows
};

/// What curves are made from: every proposal of a set of frames.
struct DetectionLog {
  long frames = 0;
  long expected = 0;  ///< true people
  std::vector<JudgedProposal> proposals;
};

/// What is left at one threshold. Shares of nothing are NaN.
struct DetectionPoint {
  double threshold = 0.0;
  double rate = 0.0;             ///< share of the true people found
  double false_per_frame = 0.0;  ///< people who are none
  double part_rate = 0.0;        ///< of the people found: share of the visible parts that are right
  double upper_part_rate = 0.0;  ///< of the upper body's
};

/// Returns a point for each fewest number of parts, 1 to `max_parts`, over the proposals whose score is at least
/// `min_score` (the paper's Figs 9 to 14).
std::vector<DetectionPoint> sweep_parts(const DetectionLog& log, int max_parts, double min_score);

/// Returns a point for each least score 0, 1/steps, ... 1, over the proposals that have at least `min_parts` parts.
std::vector<DetectionPoint> sweep_score(const DetectionLog& log, int steps, int min_parts);

}  // namespace vesalius
