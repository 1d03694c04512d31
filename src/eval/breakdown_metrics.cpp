#include "eval/breakdown_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "eval/people_metrics.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

/// Upper ends of ranges; a value above the last belongs to the last range.
constexpr std::array<float, 5> kDistances_m = {1.F, 2.F, 3.F, 4.F, 20.F};
constexpr std::array<const char*, 5> kDistanceNames = {"0-1m", "1-2m", "2-3m", "3-4m", "4m-"};
constexpr std::array<float, 4> kShares = {0.25F, 0.5F, 0.75F, 1.F};
constexpr std::array<const char*, 4> kShareNames = {"0-25%", "25-50%", "50-75%", "75-100%"};
constexpr std::array<const char*, 3> kHeadingNames = {"front", "side", "back"};
constexpr float kFront_rad = std::numbers::pi_v<float> / 3.F;
constexpr float kBack_rad = 2.F * std::numbers::pi_v<float> / 3.F;
constexpr float kLeastAcross_m = 0.1F;

template <std::size_t N>
int range_of(const std::array<float, N>& ends, float value) {
  const auto end = std::ranges::find_if(ends, [&](float e) { return value < e; });
  return static_cast<int>(std::min<std::ptrdiff_t>(end - ends.begin(), N - 1));
}

Vector3f mean_of(const std::vector<Vector3f>& points) {
  Vector3f sum = Vector3f::Zero();
  float count = 0.F;
  for (const Vector3f& p : points) {
    if (p.hasNaN()) continue;
    sum += p;
    count += 1.F;
  }
  return sum / std::max(1.F, count);
}

/// Returns the mean vector from right parts to their left partners, seen from above (x right, z forward), metres.
Eigen::Vector2f right_to_left(const std::vector<Vector3f>& centres, const BodyModel& body) {
  Vector3f sum = Vector3f::Zero();
  float pairs = 0.F;
  for (std::size_t p = 0; p < centres.size(); ++p) {
    if (!body.parts[p].name.starts_with("l_")) continue;
    const Vector3f across = centres[p] - centres[body.parts[p].mirror];
    if (across.hasNaN()) continue;
    sum += across;
    pairs += 1.F;
  }
  sum /= std::max(1.F, pairs);
  return {sum.x(), sum.z()};
}

/// Returns an index in kHeadingNames, or nothing for somebody whose left and right lie above each other.
std::optional<int> heading_of(const std::vector<Vector3f>& centres, const BodyModel& body) {
  const Eigen::Vector2f left = right_to_left(centres, body);
  const Vector3f centre = mean_of(centres);
  const Eigen::Vector2f to_camera(-centre.x(), -centre.z());
  if (left.norm() < kLeastAcross_m || to_camera.norm() == 0.F) return std::nullopt;
  const Eigen::Vector2f front(left.y(), -left.x());  // whose left is at the picture's right faces the camera
  const float turn = std::acos(std::clamp(front.dot(to_camera) / (front.norm() * to_camera.norm()), -1.F, 1.F));
  return turn <= kFront_rad ? 0 : turn <= kBack_rad ? 1 : 2;
}

float share_visible(const TrueFrame& frame, int person, const BodyModel& body) {
  const std::vector<Vector3f> parts = visible_parts(frame, person, body);
  const auto visible = std::ranges::count_if(parts, [](const Vector3f& p) { return !p.hasNaN(); });
  return static_cast<float>(visible) / static_cast<float>(body.part_count());
}

}  // namespace

MetricTerms breakdown_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                            const BodyModel& body) {
  MetricTerms terms;
  if (frame.truth.labels.empty()) return terms;
  for (std::size_t who = 0; who < of_person.size() && who < frame.truth.joints.size(); ++who) {
    const std::vector<Vector3f>& centres = frame.truth.joints[who];
    if (centres.size() != body.parts.size()) continue;
    const double found = of_person[who] != nullptr ? 1.0 : 0.0;
    const auto add = [&](Metric metric, int range, const char* name) {
      terms.push_back({{metric, range, name}, found, 1.0});
    };
    const int distance = range_of(kDistances_m, mean_of(centres).norm());
    add(Metric::distance, distance, kDistanceNames[distance]);
    if (const auto heading = heading_of(centres, body)) add(Metric::heading, *heading, kHeadingNames[*heading]);
    const int visible = range_of(kShares, share_visible(frame, static_cast<int>(who), body));
    add(Metric::visible, visible, kShareNames[visible]);
  }
  return terms;
}

}  // namespace vesalius
