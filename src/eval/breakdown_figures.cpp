#include "eval/breakdown_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "eval/people_figures.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

/// Upper ends of ranges; what is above the last is in the last.
constexpr std::array<float, 5> kDistances_m = {1.F, 2.F, 3.F, 4.F, 20.F};
constexpr std::array<const char*, 5> kDistanceNames = {"distance.0-1m", "distance.1-2m", "distance.2-3m",
                                                       "distance.3-4m", "distance.4m-"};
constexpr std::array<float, 4> kShares = {0.25F, 0.5F, 0.75F, 1.F};
constexpr std::array<const char*, 4> kShareNames = {"visible.0-25%", "visible.25-50%", "visible.50-75%",
                                                    "visible.75-100%"};
constexpr float kFront_rad = std::numbers::pi_v<float> / 3.F;
constexpr float kBack_rad = 2.F * std::numbers::pi_v<float> / 3.F;
constexpr float kLeastAcross_m = 0.1F;

template <std::size_t N>
std::size_t range_of(const std::array<float, N>& ends, float value) {
  const auto end = std::ranges::find_if(ends, [&](float e) { return value < e; });
  return std::min<std::size_t>(static_cast<std::size_t>(end - ends.begin()), N - 1);
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

/// From the right to the left parts, level with the camera's picture (x right, z forward), metres.
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

/// Null where it cannot be told.
const char* heading_of(const std::vector<Vector3f>& centres, const BodyModel& body) {
  const Eigen::Vector2f left = right_to_left(centres, body);
  const Vector3f centre = mean_of(centres);
  const Eigen::Vector2f to_camera(-centre.x(), -centre.z());
  if (left.norm() < kLeastAcross_m || to_camera.norm() == 0.F) return nullptr;
  const Eigen::Vector2f front(left.y(), -left.x());  // whose left is at the picture's right faces the camera
  const float turn = std::acos(std::clamp(front.dot(to_camera) / (front.norm() * to_camera.norm()), -1.F, 1.F));
  return turn <= kFront_rad ? "heading.front" : turn <= kBack_rad ? "heading.side" : "heading.back";
}

float share_visible(const TrueFrame& frame, int person, const BodyModel& body) {
  const std::vector<Vector3f> parts = visible_parts(frame, person, body);
  const auto visible = std::ranges::count_if(parts, [](const Vector3f& p) { return !p.hasNaN(); });
  return static_cast<float>(visible) / static_cast<float>(body.part_count());
}

}  // namespace

FigureTerms breakdown_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                            const BodyModel& body) {
  FigureTerms terms;
  if (frame.truth.labels.empty()) return terms;
  for (std::size_t who = 0; who < of_person.size() && who < frame.truth.joints.size(); ++who) {
    const std::vector<Vector3f>& centres = frame.truth.joints[who];
    if (centres.size() != body.parts.size()) continue;
    const double found = of_person[who] != nullptr ? 1.0 : 0.0;
    terms.push_back({kDistanceNames[range_of(kDistances_m, mean_of(centres).norm())], found, 1.0});
    if (const char* heading = heading_of(centres, body)) terms.push_back({heading, found, 1.0});
    terms.push_back({kShareNames[range_of(kShares, share_visible(frame, static_cast<int>(who), body))], found, 1.0});
  }
  return terms;
}

}  // namespace vesalius
