#include "eval/joint_metrics.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

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

void add_mean(MetricTerms& terms, MetricId id, double mean_m) {
  if (std::isfinite(mean_m)) terms.push_back({std::move(id), mean_m, 1.0});
}

}  // namespace

std::vector<Eigen::Vector3f> joints_by_name(const std::vector<std::string>& names, const JointSet& set,
                                            const std::vector<Joint>& joints) {
  constexpr float kNotFound = std::numeric_limits<float>::quiet_NaN();
  std::vector<Eigen::Vector3f> positions;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(set.joints, name, &JointDefinition::name);
    if (found == set.joints.end()) throw Error(fmt::format("joint set {}: no joint {}", set.name, name));
    const auto index = found - set.joints.begin();
    const bool has = index < std::ssize(joints) && joints[index].state != State::none;
    positions.push_back(has ? joints[index].position : Eigen::Vector3f::Constant(kNotFound));
  }
  return positions;
}

const JointSet* find_joint_set(const BodyModel& body, const std::vector<std::string>& names, std::string_view wanted) {
  const JointSet* first = nullptr;
  for (const JointSet& set : body.joint_sets) {
    const auto has = [&](const std::string& name) {
      return std::ranges::find(set.joints, name, &JointDefinition::name) != set.joints.end();
    };
    if (!std::ranges::all_of(names, has)) continue;
    if (set.name == wanted) return &set;
    if (first == nullptr) first = &set;
  }
  return first;
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
  const std::vector<double> errors = joint_errors(pair);
  double right = 0.0;
  double known = 0.0;
  for (std::size_t j = 0; j < errors.size(); ++j) {
    if (std::isnan(errors[j])) continue;
    const bool is_right = errors[j] < kJointTolerance_m;
    known += 1.0;
    right += is_right ? 1.0 : 0.0;
    const int place = static_cast<int>(j);
    terms.push_back({{Metric::joint_at_10cm, place, names[j]}, is_right ? 1.0 : 0.0, 1.0});
    add_mean(terms, {Metric::joint_error, place, names[j]}, errors[j]);
  }
  if (known > 0.0) terms.push_back({Metric::joints_at_10cm, right, known});
  const MeanErrors means = mean_joint_errors(pair, names);
  add_mean(terms, Metric::joints_error, means.absolute_m);
  add_mean(terms, Metric::joints_root_aligned_error, means.root_aligned_m);
  add_mean(terms, Metric::joints_procrustes_error, means.procrustes_m);
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

double JointCurve::share(int cm) const {
  return joints > 0 ? static_cast<double>(within.at(cm - 1)) / static_cast<double>(joints) : kNaN;
}

std::vector<JointOffset> joint_offsets(const JointPair& pair, const std::vector<std::string>& names,
                                       const JointSet& set) {
  std::vector<JointOffset> offsets;
  for (const std::size_t j : common_joints(pair).joints) {
    const auto definition = std::ranges::find(set.joints, names[j], &JointDefinition::name);
    const Eigen::Vector3d found = pair.found[j].cast<double>();
    const double behind_m = (pair.truth[j].cast<double>() - found).dot(found.normalized());
    offsets.push_back({set.name, names[j], behind_m + static_cast<double>(definition->depth_offset_m)});
  }
  return offsets;
}

}  // namespace vesalius
