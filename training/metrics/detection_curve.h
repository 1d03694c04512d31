#pragma once

#include <vector>

#include "metrics/people_metrics.h"

namespace vesalius {

/// A proposal of one frame and whether it is right.
struct JudgedProposal {
  float score = 0.F;
  int parts = 0;  ///< number of observed parts
  bool person = false;
  PartCounts counts;  ///< compared with the person that it shows
};

/// The data of curves: every proposal of a set of frames.
struct DetectionLog {
  long frames = 0;
  long expected = 0;  ///< true people
  std::vector<JudgedProposal> proposals;
};

/// The figures at one threshold. Shares of nothing are NaN.
struct DetectionPoint {
  double threshold = 0.0;
  double rate = 0.0;             ///< share of the true people found
  double false_per_frame = 0.0;  ///< number of false people
  double part_rate = 0.0;        ///< share of the visible parts of found people that are right
  double upper_part_rate = 0.0;  ///< the same for parts of the upper body
};

/// Returns a point for each minimum number of parts, 1 to `max_parts`, over the proposals whose score is at least
/// `min_score` (the paper's Figs 9 to 14).
std::vector<DetectionPoint> sweep_parts(const DetectionLog& log, int max_parts, double min_score);

/// Returns a point for each minimum score 0, 1/steps, ... 1, over the proposals that have at least `min_parts` parts.
std::vector<DetectionPoint> sweep_score(const DetectionLog& log, int steps, int min_parts);

}  // namespace vesalius
