#include "metrics/joint_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <optional>

#include "metrics/frame_truth.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr double kMillimetres = 1e3;
constexpr double kLeastAxis_m = 0.05;
/// Distance from a joint within which its person's surface counts for it, metres: half the width of a thick limb.
constexpr double kSightRadius_m = 0.15;
/// Smallest area of that surface that the camera sees of a joint that is seen, cm^2.
constexpr double kSight_cm2 = 10.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Adds which joints are right, under the metrics of each and of all.
void add_right(const std::vector<double>& errors, const std::vector<std::string>& names, Metric each, Metric all,
               MetricTerms& terms) {
  double right = 0.0;
  double known = 0.0;
  for (std::size_t j = 0; j < errors.size(); ++j) {
    if (std::isnan(errors[j])) continue;
    const bool is_right = errors[j] < kJointTolerance_m;
    known += 1.0;
    right += is_right ? 1.0 : 0.0;
    terms.push_back({{each, int(j), names[j]}, is_right ? 1.0 : 0.0, 1.0});
  }
  if (known > 0.0) terms.push_back({all, right, known});
}

/// Returns whether a joint lies nearer to its partner's truth than to its own.
bool is_swapped(const JointPair& pair, std::size_t joint, int partner) {
  if (partner < 0 || !pair.truth[partner].allFinite()) return false;
  const Eigen::Vector3f& found = pair.found[joint];
  return (found - pair.truth[partner]).norm() < (found - pair.truth[joint]).norm();
}

/// Returns the mean of those of the joints that are known; nothing if none is.
std::optional<Eigen::Vector3d> middle_of(const std::vector<Eigen::Vector3f>& truth,
                                         const std::vector<std::string>& names,
                                         std::initializer_list<std::string_view> joints) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (std::ranges::find(joints, names[j]) == joints.end() || !truth[j].allFinite()) continue;
    sum += truth[j].cast<double>();
    count += 1.0;
  }
  return count == double(joints.size()) ? std::optional(Eigen::Vector3d(sum / count)) : std::nullopt;
}

/// Returns the unit vector from the hips to the neck.
std::optional<Eigen::Vector3d> body_up(const std::vector<Eigen::Vector3f>& truth,
                                       const std::vector<std::string>& names) {
  const auto of = [&](std::initializer_list<std::string_view> joints) { return middle_of(truth, names, joints); };
  auto low = of({"hip_center"}), high = of({"shoulder_center"});
  if (!low) low = of({"l_hip", "r_hip"});
  if (!high) high = of({"neck"});
  if (!high) high = of({"l_shoulder", "r_shoulder"});
  if (!low || !high || (*high - *low).norm() < kLeastAxis_m) return std::nullopt;
  return (*high - *low).normalized();
}

/// Returns a joint of those in the order of `set`; null if it was not found. Throws Error if the set has none so named.
const Joint* joint_of(const std::string& name, const JointSet& set, const std::vector<Joint>& joints) {
  const auto found = std::ranges::find(set.joints, name, &JointDefinition::name);
  if (found == set.joints.end()) throw Error(fmt::format("joint set {}: no joint {}", set.name, name));
  const auto index = found - set.joints.begin();
  return index < std::ssize(joints) && joints[index].state != State::none ? &joints[index] : nullptr;
}

/// Returns the true joint nearest to a proposal that is within the tolerance and not taken, or -1.
int nearest_free(const Eigen::Vector3f& at, std::size_t joint, const std::vector<std::vector<Eigen::Vector3f>>& truth,
                 const std::vector<char>& taken) {
  int nearest = -1;
  double least = kJointTolerance_m;
  for (std::size_t person = 0; person < truth.size(); ++person) {
    const auto distance = double((truth[person][joint] - at).norm());
    if (taken[person] != 0 || distance > least) continue;
    least = distance;
    nearest = int(person);
  }
  return nearest;
}

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

std::vector<Eigen::Vector3f> joints_by_name(const std::vector<std::string>& names, const JointSet& set,
                                            const std::vector<Joint>& joints) {
  constexpr float kNotFound = std::numeric_limits<float>::quiet_NaN();
  std::vector<Eigen::Vector3f> positions;
  for (const std::string& name : names) {
    const Joint* joint = joint_of(name, set, joints);
    positions.push_back(joint != nullptr ? joint->position : Eigen::Vector3f::Constant(kNotFound));
  }
  return positions;
}

std::vector<float> confidences_by_name(const std::vector<std::string>& names, const JointSet& set,
                                       const std::vector<Joint>& joints) {
  std::vector<float> confidences;
  for (const std::string& name : names) {
    const Joint* joint = joint_of(name, set, joints);
    confidences.push_back(joint != nullptr ? joint->confidence : 0.F);
  }
  return confidences;
}

const JointSet* joint_set_with_names(const BodyModel& body, const std::vector<std::string>& names,
                                     std::string_view wanted) {
  const JointSet* first = nullptr;
  for (const JointSet& set : body.joint_sets) {
    const auto has = [&](const std::string& name) {
      return std::ranges::find(set.joints, name, &JointDefinition::name) != set.joints.end();
    };
    if (set.name == wanted && std::ranges::any_of(names, has)) return &set;
    if (first == nullptr && std::ranges::all_of(names, has)) first = &set;
  }
  return first;
}

std::optional<KnownPoints> known_joints(const FrameTruth& truth, const BodyModel& body, const std::string& joint_set) {
  if (truth.joint_names.empty()) return std::nullopt;
  const JointSet* set = joint_set_with_names(body, truth.joint_names, joint_set.empty() ? truth.joint_set : joint_set);
  if (set == nullptr) return std::nullopt;
  KnownPoints known{set, {}, std::vector<std::vector<Eigen::Vector3f>>(truth.joints.size())};
  for (std::size_t j = 0; j < truth.joint_names.size(); ++j) {
    if (std::ranges::find(set->joints, truth.joint_names[j], &JointDefinition::name) == set->joints.end()) continue;
    known.names.push_back(truth.joint_names[j]);
    for (std::size_t who = 0; who < truth.joints.size(); ++who) known.of_person[who].push_back(truth.joints[who][j]);
  }
  return known;
}

std::vector<double> joint_errors(const JointPair& pair) {
  std::vector<double> errors;
  for (std::size_t j = 0; j < pair.truth.size(); ++j) {
    if (!pair.truth[j].allFinite()) {
      errors.push_back(kNaN);
    } else if (!pair.found[j].allFinite()) {
      errors.push_back(std::numeric_limits<double>::infinity());
    } else {
      errors.push_back((pair.truth[j].cast<double>() - pair.found[j].cast<double>()).norm());
    }
  }
  return errors;
}

MetricTerms joint_terms(const JointPair& pair, const std::vector<std::string>& names) {
  const std::vector<double> errors = joint_errors(pair);
  MetricTerms terms;
  add_right(errors, names, Metric::joint_at_10cm, Metric::joints_at_10cm, terms);
  double sum = 0.0;
  double found = 0.0;
  for (std::size_t j = 0; j < errors.size(); ++j) {
    if (!std::isfinite(errors[j])) continue;
    terms.push_back({{Metric::joint_error, int(j), names[j]}, errors[j], 1.0});
    sum += errors[j];
    found += 1.0;
  }
  if (found > 0.0) terms.push_back({Metric::joints_error, sum / found, 1.0});
  return terms;
}

MetricTerms centre_terms(const JointPair& pair, const std::vector<std::string>& names) {
  MetricTerms terms;
  add_right(joint_errors(pair), names, Metric::centre_at_10cm, Metric::centres_at_10cm, terms);
  return terms;
}

MetricTerms predicted_part_terms(const Skeleton& skeleton, const JointPair& centres) {
  const std::vector<double> errors = joint_errors(centres);
  MetricTerms terms;
  for (std::size_t p = 0; p < errors.size(); ++p) {
    const State state = skeleton.parts[p].state;
    if (state == State::observed || std::isnan(errors[p])) continue;
    const bool right = state == State::predicted && errors[p] < kJointTolerance_m;
    terms.push_back({Metric::missing_right, right ? 1.0 : 0.0, 1.0});
  }
  return terms;
}

MetricTerms joint_bias_terms(const JointPair& pair, const std::vector<std::string>& names) {
  const std::optional<Eigen::Vector3d> up = body_up(pair.truth, names);
  if (!up) return {};
  MetricTerms terms;
  const SidedNames sides = sided(names);
  for (std::size_t j = 0; j < pair.truth.size(); ++j) {
    if (!pair.truth[j].allFinite() || !pair.found[j].allFinite() || is_swapped(pair, j, sides.partner[j])) continue;
    const Eigen::Vector3d off_mm = kMillimetres * (pair.found[j].cast<double>() - pair.truth[j].cast<double>());
    const auto id = [&](Metric metric) { return MetricId(metric, int(j), names[j]); };
    terms.push_back({id(Metric::joint_up), off_mm.dot(*up), 1.0});
    if (off_mm.norm() < kMillimetres * kPlacedJoint_m) {
      terms.push_back({id(Metric::joint_up_placed), off_mm.dot(*up), 1.0});
    }
  }
  return terms;
}

JointPrecision::Of& JointPrecision::of(const std::string& name) {
  const auto found = std::ranges::find(joints_, name, &Of::name);
  return found != joints_.end() ? *found : joints_.emplace_back(Of{name, 0, {}});
}

void JointPrecision::add(const std::vector<std::string>& names, std::vector<JointProposals> proposals,
                         const std::vector<std::vector<Eigen::Vector3f>>& truth, std::size_t counted) {
  std::ranges::stable_sort(proposals, [](const auto& a, const auto& b) { return a.score > b.score; });
  for (std::size_t joint = 0; joint < names.size(); ++joint) {
    if (std::ranges::any_of(truth, [&](const auto& person) { return person[joint].hasNaN(); })) continue;
    Of& sums = of(names[joint]);
    sums.known += static_cast<long>(std::min(counted, truth.size()));
    std::vector<char> taken(truth.size(), 0);
    for (const JointProposals& proposal : proposals) {
      if (proposal.joints[joint].hasNaN()) continue;
      const int person = nearest_free(proposal.joints[joint], joint, truth, taken);
      if (person >= 0) taken[person] = 1;
      if (person >= int(counted)) continue;
      sums.proposals.push_back({proposal.score, person >= 0});
    }
  }
}

void JointPrecision::add(const JointPrecision& frames) {
  for (const Of& other : frames.joints_) {
    Of& sums = of(other.name);
    sums.known += other.known;
    sums.proposals.insert(sums.proposals.end(), other.proposals.begin(), other.proposals.end());
  }
}

std::vector<std::pair<std::string, double>> JointPrecision::averages() const {
  std::vector<std::pair<std::string, double>> out;
  for (const Of& joint : joints_) {
    if (joint.known == 0) continue;
    std::vector<Judged> surest = joint.proposals;
    std::ranges::sort(surest, [](const Judged& a, const Judged& b) { return a.score > b.score; });
    std::vector<std::pair<double, double>> curve;  // right ones, precision; a point for every score that occurs
    double right = 0.0;
    for (std::size_t i = 0; i < surest.size(); ++i) {
      right += surest[i].right ? 1.0 : 0.0;
      if (i + 1 < surest.size() && surest[i + 1].score == surest[i].score) continue;
      curve.emplace_back(right, right / double(i + 1));
    }
    double area = 0.0, best = 0.0;  // from the right: the best precision at this recall or more
    for (std::size_t i = curve.size(); i-- > 0;) {
      best = std::max(best, curve[i].second);
      area += best * (curve[i].first - (i > 0 ? curve[i - 1].first : 0.0));
    }
    out.emplace_back(joint.name, area / double(joint.known));
  }
  return out;
}

std::vector<Sight> joint_sight(const TrueFrame& frame, std::size_t person, const std::vector<Eigen::Vector3f>& joints) {
  std::vector<Sight> sight(joints.size(), Sight::unknown);
  if (frame.truth.person.empty()) return sight;
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
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].allFinite()) sight[j] = area_cm2[j] >= kSight_cm2 ? Sight::seen : Sight::hidden;
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
