#include "metrics/side_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>

#include "metrics/people_metrics.h"
#include "vesalius/base/body_heading.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr double kMostRoll_deg = 45.0;
constexpr float kYawTolerance_rad = std::numbers::pi_v<float> / 4.F;
struct ConfidenceRange {
  float below;
  const char* name;
};
constexpr std::array kYawConfidences{ConfidenceRange{0.6F, "below_60"}, ConfidenceRange{0.8F, "60_to_80"},
                                     ConfidenceRange{0.9F, "80_to_90"}, ConfidenceRange{0.97F, "90_to_97"},
                                     ConfidenceRange{2.F, "over_97"}};
constexpr std::array kArmWords{"elbow", "forearm", "hand"};

double distance_m(const Vector3f& a, const Vector3f& b) { return double((a - b).norm()); }

/// Returns the centres of the observed parts; NaN for others.
std::vector<Vector3f> observed_parts(const Skeleton& skeleton) {
  std::vector<Vector3f> centres;
  for (const SkeletonPart& part : skeleton.parts) {
    const bool observed = part.state == State::observed;
    centres.push_back(observed ? part.centre : Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  }
  return centres;
}

/// Returns where each part of a true person is: the mean of its true pixels or, if it is not visible, the centre of its
/// volume.
std::vector<Vector3f> true_places(const TrueFrame& frame, std::size_t who, const BodyModel& body) {
  std::vector<Vector3f> places = frame.truth.parts[who];
  if (frame.truth.labels.empty()) return places;
  const std::vector<Vector3f> visible = visible_parts(frame, int(who), body);
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (!visible[p].hasNaN()) places[p] = visible[p];
  }
  return places;
}

/// Adds a term to a metric and, if the heading is known, to its family by heading.
void add_by_heading(Metric metric, Metric family, std::optional<Heading> heading, int count, int of,
                    MetricTerms& terms) {
  terms.push_back({metric, 1.0 * count, 1.0 * of});
  if (heading) terms.push_back({{family, int(*heading), to_string(*heading)}, 1.0 * count, 1.0 * of});
}

bool is_arm(const std::string& part) {
  return std::ranges::any_of(kArmWords, [&](const char* word) { return part.find(word) != std::string::npos; });
}

bool is_upright(const FrameTruth& truth, std::size_t who) {
  const std::string& posture = who < truth.postures.size() ? truth.postures[who] : truth.posture;
  const auto roll_deg = camera_roll_deg(truth);
  return posture != "lying" && (!roll_deg || *roll_deg < kMostRoll_deg);
}

}  // namespace

GivenPoints count_given(const SidedNames& names, const std::vector<Vector3f>& found, const std::vector<Vector3f>& truth,
                        double tolerance_m) {
  GivenPoints counts;
  for (std::size_t p = 0; p < found.size(); ++p) {
    if (found[p].hasNaN() || truth[p].hasNaN()) continue;
    const bool has_partner = names.partner[p] >= 0 && !truth[names.partner[p]].hasNaN();
    const double own_m = distance_m(found[p], truth[p]);
    const double partner_m =
        has_partner ? distance_m(found[p], truth[names.partner[p]]) : std::numeric_limits<double>::infinity();
    ++counts.all;
    counts.right += own_m <= tolerance_m ? 1 : 0;
    counts.mirrored += own_m > tolerance_m && partner_m <= tolerance_m ? 1 : 0;
    counts.paired += has_partner ? 1 : 0;
    counts.swapped += partner_m < own_m ? 1 : 0;
  }
  return counts;
}

MetricTerms given_terms(const GivenPoints& points, GivenKind kind, std::optional<Heading> heading, bool with_swapped) {
  const bool parts = kind == GivenKind::parts;
  MetricTerms terms;
  using M = Metric;
  if (points.all > 0) {
    add_by_heading(parts ? M::given_right : M::joints_given_right,
                   parts ? M::given_right_heading : M::joints_given_right_heading, heading, points.right, points.all,
                   terms);
    if (parts)
      add_by_heading(M::given_mirrored, M::given_mirrored_heading, heading, points.mirrored, points.all, terms);
  }
  if (points.paired == 0) return terms;
  const int swapped = 2 * points.swapped > points.paired ? 1 : 0;
  if (with_swapped) add_by_heading(M::sides_swapped, M::sides_swapped_heading, heading, swapped, 1, terms);
  if (!parts) terms.push_back({M::joints_swapped, 1.0 * swapped, 1.0});
  return terms;
}

MetricTerms given_part_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                             const BodyModel& body) {
  const SidedNames names = sided(body);
  MetricTerms terms;
  for (std::size_t who = 0; who < of_person.size() && who < frame.truth.parts.size(); ++who) {
    if (of_person[who] == nullptr) continue;
    const std::vector<Vector3f> places = true_places(frame, who, body);
    const GivenPoints points = count_given(names, observed_parts(of_person[who]->skeleton), places, kPartTolerance_m);
    const MetricTerms more = given_terms(points, GivenKind::parts, heading_of(frame.truth, who, body), true);
    terms.insert(terms.end(), more.begin(), more.end());
  }
  return terms;
}

MetricTerms side_order_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                             const BodyModel& body) {
  const SidedNames names = sided(body);
  MetricTerms terms;
  for (std::size_t who = 0; who < of_person.size(); ++who) {
    if (of_person[who] == nullptr || !is_upright(frame.truth, who)) continue;
    const auto heading = heading_of(frame.truth, who, body);
    if (!heading || *heading == Heading::side) continue;
    const std::vector<Vector3f> found = observed_parts(of_person[who]->skeleton);
    std::array<int, 2> in_order{};  // of the trunk and legs, of the arms
    std::array<int, 2> pairs{};
    for (std::size_t p = 0; p < found.size(); ++p) {
      if (!names.is_left(p) || names.partner[p] < 0) continue;
      const Vector3f& left = found[p];
      const Vector3f& right = found[names.partner[p]];
      if (left.hasNaN() || right.hasNaN()) continue;
      const bool left_at_the_right = left.x() / left.z() > right.x() / right.z();
      const std::size_t kind = is_arm(names.names[p]) ? 1 : 0;
      ++pairs[kind];
      in_order[kind] += left_at_the_right == (*heading == Heading::front) ? 1 : 0;
    }
    add_by_heading(Metric::sides_order, Metric::sides_order_heading, heading, in_order[0], pairs[0], terms);
    add_by_heading(Metric::sides_order_arms, Metric::sides_order_arms_heading, heading, in_order[1], pairs[1], terms);
  }
  return terms;
}

MetricTerms yaw_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person, const BodyModel& body) {
  MetricTerms terms;
  for (std::size_t who = 0; who < of_person.size() && who < frame.truth.parts.size(); ++who) {
    if (of_person[who] == nullptr || !of_person[who]->yaw) continue;
    const std::optional<float> yaw = body_yaw(frame.truth.parts[who], body);
    if (!yaw) continue;
    const YawEstimate& found = *of_person[who]->yaw;
    const float off = std::abs(std::remainder(found.yaw_rad - *yaw, 2.F * std::numbers::pi_v<float>));
    const int right = off <= kYawTolerance_rad ? 1 : 0;
    add_by_heading(Metric::yaw_right, Metric::yaw_right_heading, heading_of(frame.truth, who, body), right, 1, terms);
    const auto bin = std::ranges::find_if(kYawConfidences, [&](const auto& b) { return found.confidence < b.below; });
    terms.push_back({{Metric::yaw_right_confidence, int(bin - kYawConfidences.begin()), bin->name}, 1.0 * right, 1.0});
  }
  return terms;
}

}  // namespace vesalius
