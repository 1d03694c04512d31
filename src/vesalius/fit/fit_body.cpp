#include "vesalius/fit/fit_body.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vesalius/base/options.h"
#include "vesalius/predict_parts.h"

namespace vesalius {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kRestartGain = 40.0;  // by which a fit afresh must cost less than the followed body to replace it
constexpr int kLeastCentres = 4;       // parts that a start needs
constexpr std::size_t kLeastPoints = 30;
constexpr int kLeastSupport = 4;     // points on a bone that make its joint observed
constexpr double kCovered_m = 0.15;  // by which something must be nearer than a joint to cover it

}  // namespace

/// The end of a descent.
struct BodyFitter::Solution {
  BodyState state;
  std::vector<PlacedBone> placed;
  std::unique_ptr<NormalEquations> equations;
  std::vector<FitTerms::Assigned> assigned;
  double cost = std::numeric_limits<double>::max();
};

BodyFitter::BodyFitter(BodyModel body, FitOptions options, const FleshModel& flesh, const BodyTrust& trust)
    : body_(std::move(body)), options_(options), flesh_(flesh), trust_(trust), terms_(flesh_, body_, options_) {
  RangeCheck check;
  visit_options("fit.", options_, check);
  can_fit_ = std::ranges::any_of(terms_.surface().of_part, [](const auto& stretches) { return !stretches.empty(); });
}

void BodyFitter::forget_shape(ExpectedBody& expected) const {
  expected.shape = Eigen::VectorXd::Zero(flesh_.shapes);
  expected.shape_information = Eigen::MatrixXd::Identity(flesh_.shapes, flesh_.shapes);
}

bool BodyFitter::walks_backwards(const ExpectedBody& expected) const {
  constexpr double kSurely = 0.3;  // share of the full cost
  return expected.pose && terms_.walk_cost(expected, *expected.pose) > kSurely * double(options_.walk_cost);
}

BodyFitter::Solution BodyFitter::descend(BodyState start, int steps, const Evaluate& evaluate) const {
  constexpr double kEnough = 1e-3;  // share of the cost that a further step must gain
  constexpr int kTries = 4;
  Solution best;
  best.equations = std::make_unique<NormalEquations>(flesh_);
  best.state = std::move(start);
  evaluate(best.state, best.placed, *best.equations);
  auto equations = std::make_unique<NormalEquations>(flesh_);
  std::vector<PlacedBone> placed;
  double damping = 1e-2;
  for (int step = 0, tries = 0; step < steps && tries < kTries; ++step) {
    Eigen::MatrixXd matrix = best.equations->matrix();
    matrix.diagonal().array() += damping * (matrix.diagonal().array() + 1.0);
    const Eigen::VectorXd change = -matrix.llt().solve(best.equations->gradient());
    BodyState next = moved(best.state, change);
    evaluate(next, placed, *equations);
    const double gain = best.equations->cost() - equations->cost();
    if (!(gain > 0.0)) {
      damping *= 8.0;
      ++tries;
      continue;
    }
    const bool done = gain < kEnough * std::abs(best.equations->cost());
    best.state = std::move(next);
    std::swap(best.placed, placed);
    std::swap(best.equations, equations);
    damping = std::max(1e-4, 0.3 * damping);
    tries = 0;
    if (done) break;
  }
  best.cost = best.equations->cost();
  return best;
}

BodyFitter::Solution BodyFitter::fit_points(const FitData& data, BodyState start, int rounds) const {
  constexpr int kSteps = 3;  // between assignments
  Solution best;
  std::vector<PlacedBone> placed = place_bones(flesh_, start);
  for (int round = 0; round < rounds; ++round) {
    std::vector<FitTerms::Assigned> assigned = terms_.assign(data, placed);
    const double before = best.cost;
    best = descend(std::move(start), kSteps,
                   [&](const BodyState& state, std::vector<PlacedBone>& at, NormalEquations& to) {
                     terms_.evaluate_points(data, state, assigned, at, to);
                   });
    best.assigned = std::move(assigned);
    constexpr double kEnough = 5e-3;  // share of the cost that a further assignment must gain
    if (before - best.cost < kEnough * std::abs(best.cost)) break;
    start = best.state;
    placed = best.placed;
  }
  return best;
}

std::optional<BodyState> BodyFitter::first_state(const FitData& data, bool mirrored, std::size_t pose) const {
  BodyState state;
  state.shape = data.expected.shape;
  state.local.assign(flesh_.bones.size(), Eigen::Quaterniond::Identity());
  for (const LimbPrior& limb : flesh_.limbs) {
    const LimbPrior::Component& usual = limb.components[std::min(pose, limb.components.size() - 1)];
    for (std::size_t i = 0; i < limb.bones.size(); ++i) {
      state.local[limb.bones[i]] = exp_rotation(usual.mean.segment<3>(static_cast<Index>(3 * i)));
    }
  }
  // The parts of trunk and head, whose places hardly depend on the pose, tell how the body is turned.
  const std::vector<PlacedBone> rest = place_bones(flesh_, state);
  std::vector<Vector3d> model, seen;
  std::vector<double> weights;
  for (std::size_t p = 0; p < data.centres.size(); ++p) {
    if (!data.centres[p]) continue;
    const int part = mirrored ? body_.parts[p].mirror : int(p);
    if (part < 0 || terms_.surface().of_part[part].empty()) continue;
    const int index = terms_.surface().middle_of_part[part].bone;
    const FleshBone& bone = flesh_.bones[index];
    model.push_back(terms_.place_of(part, rest).middle);
    seen.emplace_back(*data.centres[p] + 0.08 * data.centres[p]->normalized());
    const bool is_trunk = bone.mirror == index || bone.parent == 0;
    weights.push_back(is_trunk ? 1.0 : 0.1);
  }
  if (int(model.size()) < kLeastCentres) return std::nullopt;
  Eigen::Matrix3Xd from(3, model.size()), onto(3, model.size());
  Eigen::VectorXd weight(model.size());
  for (std::size_t i = 0; i < model.size(); ++i) {
    from.col(static_cast<Index>(i)) = model[i];
    onto.col(static_cast<Index>(i)) = seen[i];
    weight[static_cast<Index>(i)] = weights[i];
  }
  const Eigen::Matrix3d turn = best_rotation(from, onto, weight);
  const Vector3d mean_from = from * weight / weight.sum(), mean_onto = onto * weight / weight.sum();
  state.local[0] = Eigen::Quaterniond(turn) * state.local[0];
  state.root = mean_onto + turn * (state.root - mean_from);
  return state;
}

std::optional<BodyFitter::Solution> BodyFitter::fit_afresh(const FitData& data, int first, int count) const {
  std::optional<Solution> best;
  for (int start = first; start < first + count; ++start) {
    // The labels count as they are, whatever a start takes them for.
    const bool mirrored = start % 2 == 1;
    const std::optional<BodyState> state = first_state(data, mirrored, static_cast<std::size_t>(start) / 2);
    if (!state) break;
    const Solution rough = descend(*state, options_.iterations,
                                   [&](const BodyState& at, std::vector<PlacedBone>& placed, NormalEquations& to) {
                                     terms_.evaluate_centres(data, at, mirrored, placed, to);
                                   });
    Solution solution = fit_points(data, rough.state, options_.rounds);
    if (!best || cost(data, solution) < cost(data, *best)) best = std::move(solution);
  }
  return best;
}

/// Returns what solutions are compared by.
double BodyFitter::cost(const FitData& data, const Solution& solution) const {
  return solution.cost + terms_.walk_cost(data.expected, solution.state);
}

/// The same by what is expected now, which has changed since the descent.
double BodyFitter::cost_anew(const FitData& data, const Solution& solution) const {
  NormalEquations equations(flesh_);
  std::vector<PlacedBone> placed;
  terms_.evaluate_points(data, solution.state, solution.assigned, placed, equations);
  return equations.cost() + terms_.walk_cost(data.expected, solution.state);
}

std::optional<BodyFit> BodyFitter::fit(const Frame& frame, const Person& person, const ExpectedBody& expected) const {
  if (!can_fit_) return std::nullopt;
  FitData data;
  data.points = person.points;
  if (data.points.size() < kLeastPoints) return std::nullopt;
  data.silhouette.emplace(frame, person.mask, person.box);
  data.centres.resize(body_.parts.size());
  for (std::size_t p = 0; p < body_.parts.size(); ++p) {
    if (person.skeleton.parts[p].state == State::observed) {
      data.centres[p] = person.skeleton.parts[p].centre.cast<double>();
    }
  }
  data.middles = known_middles(body_.distribution, person.skeleton);
  const auto is_finite = [](const KnownMiddle& known) { return known.at.allFinite() && std::isfinite(known.sigma_m); };
  if (!std::ranges::all_of(data.middles, is_finite)) data.middles.clear();
  data.expected = expected;
  if (data.expected.shape.size() == 0) forget_shape(data.expected);
  if (!data.expected.pose) {
    const std::optional<Solution> solution = fit_afresh(data, 0, kStarts);
    if (!solution) return std::nullopt;
    return report(data, person.score, *solution);
  }
  BodyState start = *data.expected.pose;
  start.shape = data.expected.shape;
  const Solution followed = fit_points(data, std::move(start), options_.rounds);
  if (expected.start >= 0) {
    // A body that lost its person stays near itself; without the expected pose both have the same chance. The shape may
    // have been learned from a wrong body, too.
    data.expected.pose.reset();
    const double least = cost_anew(data, followed) - kRestartGain;
    forget_shape(data.expected);
    const std::optional<Solution> afresh = fit_afresh(data, expected.start, 1);
    if (afresh && cost(data, *afresh) < least) {
      BodyFit fit = report(data, person.score, *afresh);
      fit.restarted = true;
      return fit;
    }
  }
  return report(data, person.score, followed);
}

BodyFit BodyFitter::report(const FitData& data, float score, const Solution& solution) const {
  const StateLayout layout(flesh_);
  BodyFit fit;
  fit.state = solution.state;
  const std::vector<FitTerms::Support> support = terms_.support(data, solution.placed, solution.assigned);
  Eigen::MatrixXd matrix = solution.equations->matrix();
  matrix.diagonal().array() += 1e-6;
  const Eigen::LLT<Eigen::MatrixXd> solver(matrix);
  // What the points tell of the shape where the pose is not known: the rest of the unknowns is integrated out.
  Eigen::MatrixXd shape_columns = Eigen::MatrixXd::Zero(layout.size(), layout.shapes);
  shape_columns.bottomRows(layout.shapes).setIdentity();
  const Eigen::MatrixXd shape_covariance = solver.solve(shape_columns).bottomRows(layout.shapes);
  fit.shape_information = shape_covariance.inverse() - data.expected.shape_information;
  FittedBody& body = fit.body;
  body.misfit = float(solution.cost / double(data.points.size()));
  for (Index k = 0; k < solution.state.shape.size(); ++k) body.shape.push_back(float(solution.state.shape[k]));
  TrustSignals of_all;
  of_all.misfit = body.misfit;
  of_all.shape = float(solution.state.shape.norm());
  of_all.score = score_log_odds(score);
  for (int b = 0; b < flesh_.bone_count(); ++b) {
    const PlacedBone& placed = solution.placed[b];
    FittedBone& bone = body.bones.emplace_back();
    bone.head = placed.head.cast<float>();
    bone.tail = placed.tail.cast<float>();
    bone.global = Eigen::Quaternionf(Eigen::Quaterniond(placed.global).cast<float>());
    bone.local = solution.state.local[b].cast<float>();
    bone.length_m = float((placed.tail - placed.head).norm());
    bone.support = support[b].on;
    const int parent = flesh_.bones[b].parent;
    const int about = support[b].on + (parent >= 0 ? support[parent].on : 0);
    bone.state = support[b].on >= kLeastSupport && about >= 2 * kLeastSupport ? State::observed : State::predicted;
    const auto covariance_of = [&](const Vector3d& at) {
      const Eigen::Matrix3Xd by_state = solution.equations->point_by_state(b, at, solution.placed);
      return Eigen::Matrix3d(by_state * solver.solve(by_state.transpose()));
    };
    const auto signals_of = [&](const Vector3d& at, const Eigen::Matrix3d& covariance) {
      TrustSignals signals = of_all;
      signals.log_sigma = float(0.5 * std::log(std::max(covariance.trace() / 3.0, 1e-8)));
      signals.bone_misfit = float(support[b].misfit);
      const Silhouette::Sight sight = data.silhouette->look(at, kCovered_m);
      signals.free = sight.kind == Silhouette::Sight::Kind::behind ? 1.F : 0.F;
      return signals;
    };
    const Eigen::Matrix3d covariance = covariance_of(placed.head);
    bone.covariance = covariance.cast<float>();
    bone.of_head = signals_of(placed.head, covariance);
    bone.of_tail = signals_of(placed.tail, covariance_of(placed.tail));
    bone.confidence = trusted(trust_, source_of(body, bone), bone.of_head);
    bone.tail_confidence = trusted(trust_, source_of(body, bone), bone.of_tail);
  }
  body.stature_m = float(stature(flesh_, solution.state.shape));
  return fit;
}

}  // namespace vesalius
