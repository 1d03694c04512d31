#include "metrics/motion_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "metrics/joint_metrics.h"
#include "metrics/statistics.h"

namespace vesalius {
namespace {

using Eigen::Vector3d;

constexpr double kMillimetres = 1e3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string bone_joint(std::size_t bone, const char* joint) {
  return (bone < kLimbBones.size() ? "l_" : "r_") + std::string(joint);
}

const LimbBone& limb_bone(std::size_t bone) { return kLimbBones[bone % kLimbBones.size()]; }

/// Returns the usual time between two frames, or 0 without two.
double usual_period_s(const std::vector<PersonMotion>& people) {
  std::vector<double> periods;
  for (const PersonMotion& person : people) {
    for (std::size_t i = 1; i < person.size(); ++i) {
      if (person[i].frame == person[i - 1].frame + 1) periods.push_back(person[i].time_s - person[i - 1].time_s);
    }
  }
  return periods.empty() ? 0.0 : median(std::move(periods));
}

/// Returns whether a step follows the other as frames usually do.
bool follows(const MotionStep& before, const MotionStep& step, double period_s) {
  const double passed_s = step.time_s - before.time_s;
  return step.frame == before.frame + 1 && passed_s > 0.5 * period_s && passed_s < 1.5 * period_s;
}

/// A joint's places in three frames.
using Places = std::array<Vector3d, 3>;

/// Returns the second divided difference, m/s^2, which at even times is that of the places over the square of the time.
double acceleration(const Places& places, const std::array<double, 3>& times_s) {
  const Vector3d before = (places[1] - places[0]) / (times_s[1] - times_s[0]);
  const Vector3d after = (places[2] - places[1]) / (times_s[2] - times_s[1]);
  return 2.0 * (after - before).norm() / (times_s[2] - times_s[0]);
}

void add_jitter(const PersonMotion& person, double period_s, std::vector<MetricTerms>& frames) {
  for (std::size_t i = 2; i < person.size(); ++i) {
    const std::array<const MotionStep*, 3> steps{&person[i - 2], &person[i - 1], &person[i]};
    if (!follows(*steps[0], *steps[1], period_s) || !follows(*steps[1], *steps[2], period_s)) continue;
    if (steps[2]->id == 0 || steps[0]->id != steps[2]->id || steps[1]->id != steps[2]->id) continue;
    const std::array times_s{steps[0]->time_s, steps[1]->time_s, steps[2]->time_s};
    double found = 0.0, truth = 0.0, count = 0.0;
    for (std::size_t j = 0; j < steps[2]->found.size(); ++j) {
      Places found_places, true_places;
      for (std::size_t s = 0; s < steps.size(); ++s) {
        found_places[s] = steps[s]->found[j].cast<double>();
        true_places[s] = steps[s]->truth[j].cast<double>();
      }
      const double of_found = acceleration(found_places, times_s), of_truth = acceleration(true_places, times_s);
      if (!std::isfinite(of_found) || !std::isfinite(of_truth)) continue;
      found += kMillimetres * of_found;
      truth += kMillimetres * of_truth;
      count += 1.0;
    }
    if (count == 0.0) continue;
    frames[steps[2]->frame].push_back({Metric::joints_jitter, found, count});
    frames[steps[2]->frame].push_back({Metric::joints_true_jitter, truth, count});
  }
}

/// Returns the median of each true length over a sequence; NaN for one that is never known.
BoneLengths true_lengths(const PersonMotion& person) {
  BoneLengths lengths{};
  for (std::size_t b = 0; b < lengths.size(); ++b) {
    std::vector<double> known;
    for (const MotionStep& step : person) {
      if (std::isfinite(step.true_bones_m[b]) && step.true_bones_m[b] > 0.0) known.push_back(step.true_bones_m[b]);
    }
    lengths[b] = known.empty() ? kNaN : median(std::move(known));
  }
  return lengths;
}

double standard_deviation(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  const double mean = sum / double(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / double(values.size()));
}

void add_bones(const PersonMotion& person, std::vector<MetricTerms>& frames) {
  const BoneLengths truth_m = true_lengths(person);
  struct Settled {
    std::size_t last_frame = 0;
    std::array<std::vector<double>, std::tuple_size_v<BoneLengths>> lengths_m;
  };
  std::map<int, Settled> of_track;
  for (const MotionStep& step : person) {
    if (step.id == 0 || step.track_age < kSettledFrames) continue;
    Settled& settled = of_track[step.id];
    settled.last_frame = step.frame;
    for (std::size_t b = 0; b < truth_m.size(); ++b) {
      if (!std::isfinite(step.found_bones_m[b]) || !std::isfinite(truth_m[b])) continue;
      const double error = std::abs(step.found_bones_m[b] - truth_m[b]) / truth_m[b];
      frames[step.frame].push_back({Metric::bones_error, error, 1.0});
      settled.lengths_m[b].push_back(step.found_bones_m[b]);
    }
  }
  for (const auto& [id, settled] : of_track) {
    for (std::size_t b = 0; b < truth_m.size(); ++b) {
      if (settled.lengths_m[b].size() < kSettledFrames) continue;
      const double spread = standard_deviation(settled.lengths_m[b]) / truth_m[b];
      frames[settled.last_frame].push_back({Metric::bones_spread, spread, 1.0});
    }
  }
}

}  // namespace

BoneLengths bone_lengths(const std::vector<std::string>& names, const std::vector<Eigen::Vector3f>& joints) {
  BoneLengths lengths{};
  for (std::size_t b = 0; b < lengths.size(); ++b) {
    const auto from = std::ranges::find(names, bone_joint(b, limb_bone(b).from));
    const auto to = std::ranges::find(names, bone_joint(b, limb_bone(b).to));
    const bool known = from != names.end() && to != names.end();
    lengths[b] = known ? double((joints[from - names.begin()] - joints[to - names.begin()]).norm()) : kNaN;
  }
  return lengths;
}

BoneLengths bone_lengths(const BodyModel& body, const std::string& preferred,
                         const std::vector<std::vector<Joint>>& joints) {
  BoneLengths lengths{};
  for (std::size_t b = 0; b < lengths.size(); ++b) {
    const std::vector<std::string> ends{bone_joint(b, limb_bone(b).from), bone_joint(b, limb_bone(b).to)};
    const auto has = [&](const JointSet& set) {
      return std::ranges::all_of(ends, [&](const std::string& name) {
        return std::ranges::find(set.joints, name, &JointDefinition::name) != set.joints.end();
      });
    };
    const auto& sets = body.joint_sets;
    auto set = std::ranges::find_if(sets, [&](const JointSet& s) { return s.name == preferred && has(s); });
    if (set == sets.end()) set = std::ranges::find_if(sets, has);
    lengths[b] = kNaN;
    if (set == sets.end()) continue;
    const std::vector<Eigen::Vector3f> places = joints_by_name(ends, *set, joints.at(set - sets.begin()));
    lengths[b] = double((places[0] - places[1]).norm());
  }
  return lengths;
}

void add_motion_terms(const std::vector<PersonMotion>& people, std::vector<MetricTerms>& frames) {
  const double period_s = usual_period_s(people);
  for (const PersonMotion& person : people) {
    add_bones(person, frames);
    if (period_s > 0.0) add_jitter(person, period_s, frames);
  }
}

}  // namespace vesalius
