#include "metrics/joint_sight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace vesalius {
namespace {

/// The metrics of the joints that are seen, or of those that are hidden.
struct SightMetrics {
  Metric right, error, right_confidence;
};

constexpr SightMetrics metrics_of(Sight sight) {
  if (sight == Sight::seen) {
    return {Metric::joints_seen_at_10cm, Metric::joints_seen_error, Metric::joints_seen_right_confidence};
  }
  return {Metric::joints_hidden_at_10cm, Metric::joints_hidden_error, Metric::joints_hidden_right_confidence};
}

MetricTerm by_confidence(Metric metric, float confidence, double right) {
  const int tenth = std::clamp(int(10.F * confidence), 0, 9);
  return {{metric, tenth, fmt::format("{}_to_{}", 10 * tenth, 10 * tenth + 10)}, right, 1.0};
}

}  // namespace

std::vector<Sight> joint_sight(const TrueFrame& frame, std::size_t person, const std::vector<Eigen::Vector3f>& joints) {
  if (frame.truth.person.empty()) return std::vector<Sight>(joints.size(), Sight::unknown);
  constexpr double kCm2PerM2 = 1e4;
  const Camera& camera = frame.frame.camera;
  const DepthImage& depth = frame.frame.depth;
  const double scale = kCm2PerM2 / (double(camera.fx) * double(camera.fy));
  std::vector<double> area_cm2(joints.size(), 0.0);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) == 0 || frame.truth.person(u, v) != person) continue;
      const Eigen::Vector3f point = point_at(camera, depth, u, v);
      const double pixel_cm2 = double(point.z()) * double(point.z()) * scale;
      for (std::size_t j = 0; j < joints.size(); ++j) {
        if (double((point - joints[j]).norm()) <= kSightRadius_m) area_cm2[j] += pixel_cm2;
      }
    }
  }
  std::vector<Sight> sight;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    sight.push_back(!joints[j].allFinite() ? Sight::unknown : area_cm2[j] >= kSight_cm2 ? Sight::seen : Sight::hidden);
  }
  return sight;
}

MetricTerms sight_terms(const JointPair& pair, const std::vector<float>& confidences, const std::vector<Sight>& sight) {
  const std::vector<double> errors = joint_errors(pair);
  MetricTerms terms;
  for (std::size_t j = 0; j < errors.size(); ++j) {
    if (std::isnan(errors[j])) continue;
    const bool found = std::isfinite(errors[j]);
    const double right = errors[j] < kJointTolerance_m ? 1.0 : 0.0;
    if (found) terms.push_back(by_confidence(Metric::joints_right_confidence, confidences[j], right));
    if (sight[j] == Sight::unknown) continue;
    const SightMetrics metrics = metrics_of(sight[j]);
    terms.push_back({metrics.right, right, 1.0});
    if (!found) continue;
    terms.push_back({metrics.error, errors[j], 1.0});
    terms.push_back(by_confidence(metrics.right_confidence, confidences[j], right));
  }
  return terms;
}

}  // namespace vesalius
