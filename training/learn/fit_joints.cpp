#include "learn/fit_joints.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "metrics/frame_truth.h"
#include "metrics/joint_metrics.h"
#include "vesalius/base/body_heading.h"
#include "vesalius/predict_parts.h"

namespace vesalius {
namespace {

/// Errors up to this are those of places, beyond it more and more those of labels: half of the distance at which a
/// joint counts as right.
constexpr double kHuber_m = 0.05;
constexpr int kRounds = 12;  ///< rounds of reweighting; the weights change by less than a thousandth after ten
constexpr std::size_t kMostTerms = 3;
/// Share of the loss that another part must save, or an offset along the body: that is one of metres, right for people
/// of one stature alone, where shares of the ways between parts grow with a limb.
constexpr double kLeastGain = 0.02;
/// Least weight of a part, either way: a joint counts as observed only where all of its parts are.
constexpr double kLeastPart = 0.05;

double loss(double error_m) {
  const double e = std::min(error_m, kPlacedJoint_m);
  return e < kHuber_m ? 0.5 * e * e : kHuber_m * (e - 0.5 * kHuber_m);
}

/// Weight of a squared error that gives Huber's loss its slope.
double slope(double error_m) { return error_m > kPlacedJoint_m ? 0.0 : error_m < kHuber_m ? 1.0 : kHuber_m / error_m; }

/// Parts that share one weight evenly.
using Term = std::vector<int>;

/// A sample with the body's axis.
struct Prepared {
  Skeleton skeleton;  ///< without predicted parts
  Eigen::Vector3f truth;
  Eigen::Vector3f up;
};

/// Returns the samples whose observed parts give the joint as it is. Where they do not, another definition may have a
/// place, but a worse one: it must not win by that.
std::vector<Prepared> prepare(const std::vector<JointSample>& samples, const JointDefinition& joint,
                              const BodyModel& body) {
  std::vector<Prepared> prepared;
  for (const JointSample& sample : samples) {
    Prepared one{sample.skeleton, sample.truth, body_up(given_centres(sample.skeleton), body)};
    for (SkeletonPart& part : one.skeleton.parts) {
      if (part.state == State::predicted) part.state = State::none;
    }
    if (derive_joint(joint, one.skeleton, one.up).state != State::none) prepared.push_back(std::move(one));
  }
  return prepared;
}

bool same_parts(const JointDefinition& a, const JointDefinition& b) {
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    const auto found = std::ranges::find(b.parts, a.parts[i]);
    if (found == b.parts.end() || b.weights[found - b.parts.begin()] != a.weights[i]) return false;
  }
  return a.parts.size() == b.parts.size();
}

/// Returns the terms from which the joint may be made: those of its own parts, then those linked to them.
std::vector<Term> candidate_terms(const JointDefinition& joint, const BodyModel& body, bool with_neighbours) {
  std::vector<int> parts = joint.parts;
  const auto add = [&](int part) {
    if (std::ranges::find(parts, part) == parts.end()) parts.push_back(part);
  };
  for (const int part : with_neighbours ? joint.parts : std::vector<int>{}) {
    for (const BodyLink& link : body.links) {
      if (link.parent == part) add(link.child);
      if (link.child == part) add(link.parent);
    }
  }
  const bool symmetric = same_parts(joint, mirrored(joint, body));
  std::vector<Term> terms;
  for (const int part : parts) {
    const int partner = body.parts[part].mirror;
    const auto has = [&](const Term& term) { return std::ranges::find(term, part) != term.end(); };
    if (std::ranges::any_of(terms, has)) continue;
    terms.push_back(symmetric && partner != part ? Term{part, partner} : Term{part});
  }
  return terms;
}

std::optional<Eigen::Vector3d> middle(const Skeleton& skeleton, const Term& term) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int part : term) {
    if (skeleton.parts[part].state == State::none) return std::nullopt;
    sum += skeleton.parts[part].centre.cast<double>();
  }
  return sum / double(term.size());
}

/// A robust linear fit of points: each sample is three rows.
class PointFit {
 public:
  explicit PointFit(int columns) : columns_(columns) {}

  void add(const Eigen::Matrix3Xd& rows, const Eigen::Vector3d& value) {
    rows_.push_back(rows);
    values_.push_back(value);
  }
  std::size_t size() const { return rows_.size(); }

  Eigen::VectorXd solve() const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(columns_);
    std::vector<double> weights(rows_.size(), 1.0);
    for (int round = 0; round < kRounds; ++round) {
      Eigen::MatrixXd squares = 1e-9 * Eigen::MatrixXd::Identity(columns_, columns_);  // columns may be the same
      Eigen::VectorXd products = Eigen::VectorXd::Zero(columns_);
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        squares += weights[i] * rows_[i].transpose() * rows_[i];
        products += weights[i] * rows_[i].transpose() * values_[i];
      }
      x = squares.ldlt().solve(products);
      for (std::size_t i = 0; i < rows_.size(); ++i) weights[i] = slope((values_[i] - rows_[i] * x).norm());
    }
    return x;
  }

 private:
  int columns_;
  std::vector<Eigen::Matrix3Xd> rows_;
  std::vector<Eigen::Vector3d> values_;
};

/// Makes `joint` of the terms with these weights, rounded such that they sum to 1.
void set_weights(JointDefinition& joint, const std::vector<Term>& terms, const std::vector<double>& weights) {
  joint.parts.clear();
  joint.weights.clear();
  std::size_t largest = 0;
  double sum = 0.0;
  std::vector<double> each;  // hundredths of each part of a term
  for (std::size_t t = 0; t < terms.size(); ++t) {
    each.push_back(std::round(100.0 * weights[t] / double(terms[t].size())));
    sum += each[t] * double(terms[t].size());
    if (weights[t] > weights[largest]) largest = t;
  }
  each[largest] += (100.0 - sum) / double(terms[largest].size());
  for (std::size_t t = 0; t < terms.size(); ++t) {
    for (const int part : terms[t]) {
      joint.parts.push_back(part);
      joint.weights.push_back(float(each[t] / 100.0));
    }
  }
}

double to_millimetres(double metres) { return std::round(1e3 * metres) / 1e3; }

/// Fits the offsets of a joint whose weights are known, also to people of whom only some of its parts were given out.
void fit_offsets(JointDefinition& joint, bool with_up, const std::vector<Prepared>& samples) {
  joint.depth_offset_m = joint.up_offset_m = 0.F;
  const int columns = with_up ? 2 : 1;
  PointFit fit(columns);
  for (const Prepared& one : samples) {
    const Joint surface = derive_joint(joint, one.skeleton, one.up);
    if (surface.state == State::none) continue;
    Eigen::Matrix3Xd rows(3, 2);
    rows << surface.position.normalized().cast<double>(), one.up.cast<double>();
    fit.add(rows.leftCols(columns), (one.truth - surface.position).cast<double>());
  }
  if (fit.size() == 0) return;
  const Eigen::VectorXd offsets = fit.solve();
  joint.depth_offset_m = float(to_millimetres(offsets[0]));
  if (with_up) joint.up_offset_m = float(to_millimetres(offsets[1]));
}

/// Fits a joint to these terms. Returns nothing if too few samples have all terms or one hardly moves the joint.
std::optional<JointDefinition> fit_terms(const JointDefinition& joint, const std::vector<Term>& terms, bool with_up,
                                         const std::vector<Prepared>& samples) {
  const auto others = static_cast<Eigen::Index>(terms.size()) - 1;
  const auto columns = others + (with_up ? 2 : 1);
  PointFit fit{int(columns)};
  for (const Prepared& one : samples) {
    const std::optional<Eigen::Vector3d> first = middle(one.skeleton, terms[0]);
    if (!first) continue;
    Eigen::Matrix3Xd rows(3, others + 2);
    bool has_all = true;
    for (Eigen::Index t = 0; t < others && has_all; ++t) {
      const auto point = middle(one.skeleton, terms[t + 1]);
      has_all = point.has_value();
      if (has_all) rows.col(t) = *point - *first;
    }
    if (!has_all) continue;
    rows.col(others) = first->normalized();
    rows.col(others + 1) = one.up.cast<double>();
    fit.add(rows.leftCols(columns), one.truth.cast<double>() - *first);
  }
  if (fit.size() < kLeastJointSamples) return std::nullopt;
  const Eigen::VectorXd solved = fit.solve();
  std::vector<double> weights(1, 1.0 - solved.head(others).sum());
  for (Eigen::Index t = 0; t < others; ++t) weights.push_back(solved[t]);
  if (std::ranges::any_of(weights, [](double weight) { return std::abs(weight) < kLeastPart; })) return std::nullopt;
  JointDefinition fitted = joint;
  set_weights(fitted, terms, weights);
  fit_offsets(fitted, with_up, samples);
  return fitted;
}

double mean_loss(const JointDefinition& joint, const std::vector<Prepared>& samples) {
  double sum = 0.0;
  for (const Prepared& one : samples) {
    const Joint derived = derive_joint(joint, one.skeleton, one.up);
    const bool has = derived.state != State::none;
    sum += loss(has ? double((derived.position - one.truth).norm()) : kPlacedJoint_m);
  }
  return sum / double(samples.size());
}

/// The definition of least loss so far.
struct Best {
  JointDefinition joint;
  double loss = std::numeric_limits<double>::infinity();
};

/// Fits the joint to every choice of so many of the terms. One that saves too little of the loss before is not taken.
void fit_choices(const JointDefinition& joint, const std::vector<Term>& terms, std::size_t count, bool with_up,
                 const std::vector<Prepared>& samples, Best& best) {
  double allowed = (1.0 - kLeastGain) * best.loss;
  std::vector<int> chosen(terms.size(), 0);
  std::fill_n(chosen.begin(), count, 1);
  do {
    std::vector<Term> some;
    for (std::size_t t = 0; t < terms.size(); ++t) {
      if (chosen[t] != 0) some.push_back(terms[t]);
    }
    const std::optional<JointDefinition> fitted = fit_terms(joint, some, with_up, samples);
    if (!fitted) continue;
    const double cost = mean_loss(*fitted, samples);
    if (cost >= allowed) continue;
    best = {*fitted, cost};
    allowed = cost;
  } while (std::ranges::prev_permutation(chosen).found);
}

bool is_set_of_parts(const JointSet& set, const BodyModel& body) {
  const JointSet* centres = joint_set_with_names(body, sided(body).names);
  return centres != nullptr && centres->name == set.name;
}

/// Returns the true place of a joint of `set`; nothing if it is not known.
std::optional<Eigen::Vector3f> true_joint(const KnownPerson& person, const JointSet& set, const std::string& joint,
                                          const BodyModel& body) {
  const std::vector<std::string> parts = sided(body).names;
  const bool of_parts = is_set_of_parts(set, body);
  if (!of_parts && !person.joint_set.empty() && person.joint_set != set.name) return std::nullopt;
  const auto& names = of_parts ? parts : person.joint_names;
  const auto& places = of_parts ? person.part_centres : person.joints;
  const auto found = std::ranges::find(names, joint) - names.begin();
  if (found >= std::ssize(places) || !places[found].allFinite()) return std::nullopt;
  return places[found];
}

std::vector<JointSample> samples_of(const std::vector<KnownPerson>& people, const JointSet& set,
                                    const std::string& joint, const BodyModel& body) {
  std::vector<JointSample> samples;
  for (const KnownPerson& person : people) {
    const auto truth = true_joint(person, set, joint, body);
    if (truth) samples.push_back({drawn_to_votes(body.distribution, person.skeleton), *truth});
  }
  return samples;
}

/// Fits the joint and its partner on the other side to the samples of both.
void fit_pair(JointDefinition& joint, JointDefinition& partner, std::vector<JointSample> samples,
              const std::vector<JointSample>& of_partner, const BodyModel& body, bool with_neighbours) {
  for (const JointSample& one : of_partner) samples.push_back({mirrored(one.skeleton, body), one.truth});
  const std::string name = partner.name;
  joint = fit_joint(joint, samples, body, with_neighbours);
  partner = mirrored(joint, body);
  partner.name = name;
}

}  // namespace

JointDefinition mirrored(JointDefinition joint, const BodyModel& body) {
  for (int& part : joint.parts) part = body.parts[part].mirror;
  return joint;
}

Skeleton mirrored(const Skeleton& skeleton, const BodyModel& body) {
  Skeleton other = skeleton;
  for (int p = 0; p < body.part_count(); ++p) other.parts[body.parts[p].mirror] = skeleton.parts[p];
  return other;
}

JointDefinition fit_joint(const JointDefinition& joint, const std::vector<JointSample>& samples, const BodyModel& body,
                          bool with_neighbours) {
  const std::vector<Prepared> prepared = prepare(samples, joint, body);
  if (joint.parts.empty() || prepared.size() < kLeastJointSamples) return joint;
  const std::vector<Term> terms = candidate_terms(joint, body, with_neighbours);
  Best best{.joint = joint};
  for (std::size_t count = 1; count <= std::min(kMostTerms, terms.size()); ++count) {
    for (const bool with_up : {false, true}) fit_choices(joint, terms, count, with_up, prepared, best);
  }
  return best.joint;
}

std::vector<JointSet> fit_joint_sets(const std::vector<KnownPerson>& people, const BodyModel& body) {
  std::vector<JointSet> fitted;
  for (const JointSet& set : body.joint_sets) {
    JointSet result = set;
    const bool of_parts = is_set_of_parts(set, body);
    std::vector<std::string> names;
    for (const JointDefinition& joint : set.joints) names.push_back(joint.name);
    const SidedNames sides = sided(names);
    bool known = false;
    for (std::size_t j = 0; j < names.size(); ++j) {
      std::vector<JointSample> samples = samples_of(people, set, names[j], body);
      known = known || !samples.empty();
      const int partner = sides.partner[j];
      const bool paired = partner >= 0 && same_parts(mirrored(set.joints[j], body), set.joints[partner]);
      if (!paired) {
        result.joints[j] = fit_joint(set.joints[j], samples, body, !of_parts);
      } else if (sides.is_left(j)) {
        fit_pair(result.joints[j], result.joints[partner], std::move(samples),
                 samples_of(people, set, names[partner], body), body, !of_parts);
      }
    }
    if (known) fitted.push_back(std::move(result));
  }
  return fitted;
}

}  // namespace vesalius
