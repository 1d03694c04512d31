#include "metrics/people_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "metrics/frame_truth.h"
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

bool is_right(const SkeletonPart& part, const Vector3f& visible) {
  return part.state == State::observed && double((part.centre - visible).norm()) <= kPartTolerance_m;
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
    const SkeletonPart& part = skeleton.parts[p];
    const bool right = known ? is_right(part, visible[p]) : part.state == State::observed;
    ++counts.visible;
    counts.right += right ? 1 : 0;
    if (!body.parts[p].upper_body) continue;
    ++counts.visible_upper;
    counts.right_upper += right ? 1 : 0;
  }
  return counts;
}

MetricTerms found_part_terms(const Skeleton& skeleton, const std::vector<Eigen::Vector3f>& visible,
                             const BodyModel& body) {
  MetricTerms terms;
  for (const auto& [metric, least] : {std::pair{Metric::part_right_of_4, 4}, std::pair{Metric::part_right_of_8, 8}}) {
    for (std::size_t p = 0; p < visible.size() && skeleton.found >= least; ++p) {
      if (visible[p].hasNaN()) continue;
      terms.push_back({{metric, int(p), body.parts[p].name}, is_right(skeleton.parts[p], visible[p]) ? 1.0 : 0.0, 1.0});
    }
  }
  return terms;
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
