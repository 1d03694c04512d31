#include "metrics/people_metrics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "metrics/pixel_metrics.h"

namespace vesalius {
namespace {

constexpr double kCm2PerM2 = 1e4;

Mask union_of(const std::vector<Person>& people, const DepthImage& depth) {
  Mask all(depth.width(), depth.height(), 0);
  for (const Person& person : people) {
    for (std::size_t i = 0; i < all.size(); ++i) all[i] |= person.mask[i];
  }
  return all;
}

void add_mask_terms(const TrueFrame& frame, const std::vector<Person>& people, bool found, MetricTerms& terms) {
  if (frame.truth.mask.empty()) return;
  const double iou = mask_iou(union_of(people, frame.frame.depth), frame.truth.mask, frame.frame.depth);
  terms.push_back({Metric::mask_iou, iou, 1.0});
  if (found) terms.push_back({Metric::mask_iou_where_found, iou, 1.0});
}

/// Adds the terms of parts. A true person who was not found has no observed part.
void add_part_terms(const std::vector<Person>& people, const std::vector<Match>& matches, double expected,
                    const BodyModel& body, MetricTerms& terms) {
  for (int part = 0; part < body.part_count(); ++part) {
    double seen = 0.0;
    for (std::size_t i = 0; i < people.size(); ++i) {
      const bool counts = matches[i].kind == Match::Kind::person;
      seen += counts && people[i].skeleton.parts[part].state == State::observed ? 1.0 : 0.0;
    }
    terms.push_back({{Metric::part_seen, part, body.parts[part].name}, seen, expected});
  }
}

}  // namespace

std::vector<Eigen::Vector3f> visible_parts(const TrueFrame& frame, int person, const BodyModel& body) {
  const std::size_t parts = body.parts.size();
  const Camera& camera = frame.frame.camera;
  const DepthImage& depth = frame.frame.depth;
  std::vector<Eigen::Vector3d> sum(parts, Eigen::Vector3d::Zero());
  std::vector<double> pixels(parts, 0.0);
  std::vector<double> area_m2(parts, 0.0);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const std::size_t label = frame.truth.labels(u, v);
      if (depth(u, v) == 0 || label >= parts || frame.truth.person(u, v) != person) continue;
      const Eigen::Vector3d point = point_at(camera, depth, u, v).cast<double>();
      sum[label] += point;
      pixels[label] += 1.0;
      area_m2[label] += point.z() * point.z() / (double{camera.fx} * double{camera.fy});
    }
  }
  std::vector<Eigen::Vector3f> visible(parts, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  for (std::size_t p = 0; p < parts; ++p) {
    if (area_m2[p] * kCm2PerM2 >= kVisiblePart_cm2) visible[p] = (sum[p] / pixels[p]).cast<float>();
  }
  return visible;
}

PartCounts count_parts(const Skeleton& skeleton, const std::vector<Eigen::Vector3f>& visible, const BodyModel& body) {
  PartCounts counts;
  for (std::size_t p = 0; p < skeleton.parts.size(); ++p) {
    const bool known = !visible.empty();
    if (known && visible[p].hasNaN()) continue;
    const bool observed = skeleton.parts[p].state == State::observed;
    const bool right =
        observed && (!known || double((skeleton.parts[p].centre - visible[p]).norm()) <= kPartTolerance_m);
    ++counts.visible;
    counts.right += right ? 1 : 0;
    if (!body.parts[p].upper_body) continue;
    ++counts.visible_upper;
    counts.right_upper += right ? 1 : 0;
  }
  return counts;
}

MetricTerms visible_part_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                               const BodyModel& body) {
  if (frame.truth.labels.empty()) return {};
  Skeleton nothing;
  nothing.parts.resize(body.parts.size());
  MetricTerms terms;
  for (std::size_t who = 0; who < of_person.size(); ++who) {
    const Skeleton& skeleton = of_person[who] != nullptr ? of_person[who]->skeleton : nothing;
    const PartCounts counts = count_parts(skeleton, visible_parts(frame, int(who), body), body);
    terms.push_back({Metric::parts_right, 1.0 * counts.right, 1.0 * counts.visible});
    terms.push_back({Metric::parts_right_upper, 1.0 * counts.right_upper, 1.0 * counts.visible_upper});
  }
  return terms;
}

MetricTerms people_terms(const TrueFrame& frame, const std::vector<Person>& people, const std::vector<Match>& matches,
                         const BodyModel& body) {
  MetricTerms terms;
  const double expected = expected_people(frame.truth);
  const auto count = [&](Match::Kind kind) { return double(std::ranges::count(matches, kind, &Match::kind)); };
  const double found = count(Match::Kind::person);
  terms.push_back({Metric::people_false, count(Match::Kind::nobody), 1.0});
  if (expected == 0.0) {
    terms.push_back({Metric::empty_with_person, people.empty() ? 0.0 : 1.0, 1.0});
    return terms;
  }
  terms.push_back({Metric::people_found, found, expected});
  add_mask_terms(frame, people, found > 0.0, terms);
  add_part_terms(people, matches, expected, body, terms);
  if (!frame.truth.posture.empty()) terms.push_back({{Metric::posture, 0, frame.truth.posture}, found, expected});
  return terms;
}

}  // namespace vesalius
