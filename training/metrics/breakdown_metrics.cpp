#include "metrics/breakdown_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "metrics/heading.h"
#include "metrics/people_metrics.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

/// Upper ends of ranges; a value above the last belongs to the last range.
constexpr std::array<float, 5> kDistances_m = {1.F, 2.F, 3.F, 4.F, 20.F};
constexpr std::array<const char*, 5> kDistanceNames = {"0-1m", "1-2m", "2-3m", "3-4m", "4m-"};
constexpr std::array<float, 4> kShares = {0.25F, 0.5F, 0.75F, 1.F};
constexpr std::array<const char*, 4> kShareNames = {"0-25%", "25-50%", "50-75%", "75-100%"};
constexpr std::array<float, 5> kStatures_m = {1.2F, 1.5F, 1.65F, 1.8F, 3.F};
constexpr std::array<const char*, 5> kStatureNames = {"0-1.2m", "1.2-1.5m", "1.5-1.65m", "1.65-1.8m", "1.8m-"};
constexpr std::array<float, 5> kRolls_deg = {15.F, 45.F, 75.F, 105.F, 180.F};
constexpr std::array<const char*, 5> kRollNames = {"0-15deg", "15-45deg", "45-75deg", "75-105deg", "105-180deg"};
constexpr double kLeastAcrossView = 0.342;  // sine of 20 degrees

template <std::size_t N>
int range_of(const std::array<float, N>& ends, float value) {
  const auto end = std::ranges::find_if(ends, [&](float e) { return value < e; });
  return int(std::min<std::ptrdiff_t>(end - ends.begin(), N - 1));
}

float share_visible(const TrueFrame& frame, int person, const BodyModel& body) {
  const std::vector<Vector3f> parts = visible_parts(frame, person, body);
  const auto visible = std::ranges::count_if(parts, [](const Vector3f& p) { return !p.hasNaN(); });
  return float(visible) / float(body.part_count());
}

}  // namespace

std::optional<double> camera_roll_deg(const FrameTruth& truth) {
  if (!truth.up) return std::nullopt;
  const Eigen::Vector2d up(double(truth.up->x()), double(truth.up->y()));
  if (up.norm() < kLeastAcrossView) return std::nullopt;
  return std::abs(std::atan2(up.x(), -up.y())) * 180.0 / std::numbers::pi;
}

MetricTerms breakdown_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                            const BodyModel& body) {
  const FrameTruth& truth = frame.truth;
  const auto roll_deg = camera_roll_deg(truth);
  MetricTerms terms;
  for (std::size_t who = 0; who < of_person.size(); ++who) {
    const double found = of_person[who] != nullptr ? 1.0 : 0.0;
    const auto add = [&](Metric metric, int range, const char* name) {
      terms.push_back({{metric, range, name}, found, 1.0});
    };
    const auto add_range = [&](Metric metric, const auto& ends, const auto& names, float value) {
      const int range = range_of(ends, value);
      add(metric, range, names[range]);
    };
    if (who < truth.parts.size()) {
      add_range(Metric::distance, kDistances_m, kDistanceNames, mean_known(truth.parts[who]).norm());
    }
    if (const auto heading = heading_of(truth, who, body)) {
      add(Metric::heading, int(*heading), to_string(*heading));
    }
    if (!truth.labels.empty()) {
      add_range(Metric::visible, kShares, kShareNames, share_visible(frame, int(who), body));
    }
    if (who < truth.postures.size()) add(Metric::posture, 0, truth.postures[who].c_str());
    if (who < truth.statures_m.size() && std::isfinite(truth.statures_m[who])) {
      add_range(Metric::stature, kStatures_m, kStatureNames, truth.statures_m[who]);
    }
    if (roll_deg) add_range(Metric::roll, kRolls_deg, kRollNames, float(*roll_deg));
  }
  return terms;
}

}  // namespace vesalius
