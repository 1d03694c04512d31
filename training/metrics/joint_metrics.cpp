#include "metrics/joint_metrics.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <optional>

#include "metrics/heading.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr double kMillimetres = 1e3;
constexpr double kLeastAxis_m = 0.05;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The joints that both sides have, as columns.
struct Common {
  Eigen::Matrix3Xd truth;
  Eigen::Matrix3Xd found;
  std::vector<std::size_t> joints;
};

Common common_joints(const JointPair& pair) {
  Common common;
  for (std::size_t j = 0; j < pair.truth.size(); ++j) {
    if (pair.truth[j].allFinite() && pair.found[j].allFinite()) common.joints.push_back(j);
  }
  const auto count = static_cast<Eigen::Index>(common.joints.size());
  common.truth.resize(3, count);
  common.found.resize(3, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    common.truth.col(c) = pair.truth[common.joints[c]].cast<double>();
    common.found.col(c) = pair.found[common.joints[c]].cast<double>();
  }
  return common;
}

double mean_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return a.cols() > 0 ? (a - b).colwise().norm().mean() : kNaN;
}

double root_aligned(const Common& common, const std::vector<std::string>& names) {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  int roots = 0;
  for (std::size_t c = 0; c < common.joints.size(); ++c) {
    if (names[common.joints[c]].find("hip") == std::string::npos) continue;
    shift += common.truth.col(c) - common.found.col(c);
    ++roots;
  }
  if (roots == 0) return kNaN;
  const Eigen::Matrix3Xd moved = common.found.colwise() + shift / roots;
  return mean_distance(common.truth, moved);
}

double after_procrustes(const Common& common) {
  if (common.joints.size() < 3) return kNaN;
  const Eigen::Vector3d middle = common.found.rowwise().mean();
  if ((common.found.colwise() - middle).squaredNorm() < 1e-12)
    return kNaN;  // all joints are at one place, so no scale fits
  const Eigen::Matrix4d fit = Eigen::umeyama(common.found, common.truth, true);
  const Eigen::Matrix3Xd moved =
      (fit.topLeftCorner<3, 3>() * common.found).colwise() + fit.topRightCorner<3, 1>().col(0);
  return mean_distance(common.truth, moved);
}

void add_mean(MetricTerms& terms, MetricId id, double mean) {
  if (std::isfinite(mean)) terms.push_back({std::move(id), mean, 1.0});
}

/// The metrics of the errors of single joints.
struct ErrorMetrics {
  Metric each_right, all_right, each_error;
};

void add_errors(const JointPair& pair, const std::vector<std::string>& names, const ErrorMetrics& metrics,
                MetricTerms& terms) {
  const std::vector<double> errors = joint_errors(pair);
  double right = 0.0;
  double known = 0.0;
  for (std::size_t j = 0; j < errors.size(); ++j) {
    if (std::isnan(errors[j])) continue;
    const bool is_right = errors[j] < kJointTolerance_m;
    known += 1.0;
    right += is_right ? 1.0 : 0.0;
    const int place = static_cast<int>(j);
    terms.push_back({{metrics.each_right, place, names[j]}, is_right ? 1.0 : 0.0, 1.0});
    add_mean(terms, {metrics.each_error, place, names[j]}, errors[j]);
  }
  if (known > 0.0) terms.push_back({metrics.all_right, right, known});
}

/// Returns whether a joint lies nearer to its partner's truth than to its own.
bool is_swapped(const JointPair& pair, std::size_t joint, int partner) {
  if (partner < 0 || !pair.truth[partner].allFinite()) return false;
  const Eigen::Vector3f& found = pair.found[joint];
  return (found - pair.truth[partner]).norm() < (found - pair.truth[joint]).norm();
}

/// Unit vectors of a body.
struct BodyAxes {
  Eigen::Vector3d up;    ///< from the hips to the neck
  Eigen::Vector3d left;  ///< from the right to the left hip and shoulder, perpendicular to `up`
};

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
  return count == static_cast<double>(joints.size()) ? std::optional(Eigen::Vector3d(sum / count)) : std::nullopt;
}

std::optional<BodyAxes> body_axes(const std::vector<Eigen::Vector3f>& truth, const std::vector<std::string>& names) {
  const auto of = [&](std::initializer_list<std::string_view> joints) { return middle_of(truth, names, joints); };
  const auto left = of({"l_hip", "l_shoulder"}), right = of({"r_hip", "r_shoulder"});
  auto low = of({"hip_center"}), high = of({"shoulder_center"});
  if (!low) low = of({"l_hip", "r_hip"});
  if (!high) high = of({"neck"});
  if (!high) high = of({"l_shoulder", "r_shoulder"});
  if (!left || !right || !low || !high) return std::nullopt;
  const Eigen::Vector3d up = *high - *low;
  const Eigen::Vector3d across = *left - *right;
  if (up.norm() < kLeastAxis_m) return std::nullopt;
  const Eigen::Vector3d level = across - across.dot(up) / up.squaredNorm() * up;
  if (level.norm() < kLeastAxis_m) return std::nullopt;
  return BodyAxes{up.normalized(), level.normalized()};
}

/// Returns a joint of those in the order of `set`; null if it was not found. Throws Error if the set has none so named.
const Joint* joint_of(const std::string& name, const JointSet& set, const std::vector<Joint>& joints) {
  const auto found = std::ranges::find(set.joints, name, &JointDefinition::name);
  if (found == set.joints.end()) throw Error(fmt::format("joint set {}: no joint {}", set.name, name));
  const auto index = found - set.joints.begin();
  return index < std::ssize(joints) && joints[index].state != State::none ? &joints[index] : nullptr;
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

const JointSet* find_joint_set(const BodyModel& body, const std::vector<std::string>& names, std::string_view wanted) {
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
  const JointSet* set = find_joint_set(body, truth.joint_names, joint_set.empty() ? truth.joint_set : joint_set);
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

MeanErrors mean_joint_errors(const JointPair& pair, const std::vector<std::string>& names) {
  const Common common = common_joints(pair);
  return {mean_distance(common.truth, common.found), root_aligned(common, names), after_procrustes(common)};
}

MetricTerms joint_terms(const JointPair& pair, const std::vector<std::string>& names) {
  MetricTerms terms;
  add_errors(pair, names, {Metric::joint_at_10cm, Metric::joints_at_10cm, Metric::joint_error}, terms);
  const MeanErrors means = mean_joint_errors(pair, names);
  add_mean(terms, Metric::joints_error, means.absolute_m);
  add_mean(terms, Metric::joints_root_aligned_error, means.root_aligned_m);
  add_mean(terms, Metric::joints_procrustes_error, means.procrustes_m);
  return terms;
}

MetricTerms centre_terms(const JointPair& pair, const std::vector<std::string>& names) {
  MetricTerms terms;
  add_errors(pair, names, {Metric::centre_at_10cm, Metric::centres_at_10cm, Metric::centre_error}, terms);
  const Common common = common_joints(pair);
  add_mean(terms, Metric::centres_error, mean_distance(common.truth, common.found));
  return terms;
}

MetricTerms predicted_part_terms(const Skeleton& skeleton, const JointPair& centres) {
  constexpr std::array kRanges{"0-20%", "20-40%", "40-60%", "60-80%", "80-100%"};
  const std::vector<double> errors = joint_errors(centres);
  MetricTerms terms;
  for (std::size_t p = 0; p < errors.size(); ++p) {
    const SkeletonPart& part = skeleton.parts[p];
    if (part.state == State::observed || std::isnan(errors[p])) continue;
    const bool predicted = part.state == State::predicted;
    const double right = predicted && errors[p] < kJointTolerance_m ? 1.0 : 0.0;
    terms.push_back({Metric::missing_right, right, 1.0});
    if (!predicted) continue;
    const int range = std::clamp(static_cast<int>(part.confidence * 5.F), 0, static_cast<int>(kRanges.size()) - 1);
    terms.push_back({Metric::predicted_right, right, 1.0});
    terms.push_back({{Metric::predicted_right_confidence, range, kRanges[range]}, right, 1.0});
  }
  return terms;
}

MetricTerms joint_bias_terms(const JointPair& pair, const std::vector<std::string>& names) {
  const std::optional<BodyAxes> axes = body_axes(pair.truth, names);
  const Common common = common_joints(pair);
  MetricTerms terms;
  const SidedNames sides = sided(names);
  for (std::size_t c = 0; c < common.joints.size(); ++c) {
    const std::size_t joint = common.joints[c];
    if (is_swapped(pair, joint, sides.partner[joint])) continue;
    const Eigen::Vector3d truth = common.truth.col(static_cast<Eigen::Index>(c));
    const Eigen::Vector3d off_mm = kMillimetres * (common.found.col(static_cast<Eigen::Index>(c)) - truth);
    const auto id = [&](Metric metric) { return MetricId(metric, static_cast<int>(joint), names[joint]); };
    if (axes) {
      const double up_mm = off_mm.dot(axes->up);
      add_mean(terms, id(Metric::joint_up), up_mm);
      if (off_mm.norm() < kMillimetres * kPlacedJoint_m) add_mean(terms, id(Metric::joint_up_placed), up_mm);
      add_mean(terms, id(Metric::joint_left), off_mm.dot(axes->left));
    }
    add_mean(terms, id(Metric::joint_behind), off_mm.dot(truth.normalized()));
  }
  return terms;
}

void JointCurve::add(const std::vector<double>& errors_m) {
  for (const double error_m : errors_m) {
    if (std::isnan(error_m)) continue;
    ++joints;
    for (int cm = 1; cm <= kJointCurve_cm; ++cm) {
      if (error_m < cm * 0.01) ++within[cm - 1];
    }
  }
}

void JointCurve::merge(const JointCurve& other) {
  joints += other.joints;
  for (std::size_t cm = 0; cm < within.size(); ++cm) within[cm] += other.within[cm];
}

double JointCurve::share(int cm) const {
  return joints > 0 ? static_cast<double>(within.at(cm - 1)) / static_cast<double>(joints) : kNaN;
}

}  // namespace vesalius
