#include "metrics/detection_curve.h"

#include <limits>

namespace vesalius {
namespace {

double share(double part, double whole) {
  return whole > 0.0 ? part / whole : std::numeric_limits<double>::quiet_NaN();
}

DetectionPoint point_at(const DetectionLog& log, double threshold, double min_score, int min_parts) {
  long found = 0;
  long wrong = 0;
  PartCounts sum;
  for (const JudgedProposal& proposal : log.proposals) {
    if (double(proposal.score) < min_score || proposal.parts < min_parts) continue;
    if (!proposal.person) {
      ++wrong;
      continue;
    }
    ++found;
    sum.visible += proposal.counts.visible;
    sum.right += proposal.counts.right;
    sum.visible_upper += proposal.counts.visible_upper;
    sum.right_upper += proposal.counts.right_upper;
  }
  return {threshold, share(double(found), double(log.expected)), share(double(wrong), double(log.frames)),
          share(sum.right, sum.visible), share(sum.right_upper, sum.visible_upper)};
}

}  // namespace

std::vector<DetectionPoint> sweep_parts(const DetectionLog& log, int max_parts, double min_score) {
  std::vector<DetectionPoint> curve;
  for (int parts = 1; parts <= max_parts; ++parts) curve.push_back(point_at(log, parts, min_score, parts));
  return curve;
}

std::vector<DetectionPoint> sweep_score(const DetectionLog& log, int steps, int min_parts) {
  std::vector<DetectionPoint> curve;
  for (int step = 0; step <= steps; ++step) {
    const double score = double(step) / steps;
    curve.push_back(point_at(log, score, score, min_parts));
  }
  return curve;
}

}  // namespace vesalius
