#include "evaluation/fit_evaluation.h"

#include <fmt/format.h>

#include <cmath>

#include "learn/boost_trees.h"
#include "learn/fit_context.h"
#include "learn/fit_distribution.h"
#include "learn/fit_joints.h"
#include "vesalius/base/error.h"
#include "vesalius/forest/body_context.h"

namespace vesalius {
namespace {

/// Returns what the sets have of one kind, all together.
template <class Kind>
std::vector<Kind> of_all_sets(const Evaluation& evaluation, std::vector<Kind> SetResult::*kind) {
  std::vector<Kind> all;
  for (const SetResult& set : evaluation.sets) all.insert(all.end(), (set.*kind).begin(), (set.*kind).end());
  return all;
}

/// Returns a number that TOML reads as a float: "1.0", not "1".
std::string number(float value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string joint_toml(const JointDefinition& joint, const BodyModel& body) {
  std::string parts, weights;
  for (std::size_t i = 0; i < joint.parts.size(); ++i) {
    const char* comma = i > 0 ? ", " : "";
    parts += fmt::format("{}\"{}\"", comma, body.parts[joint.parts[i]].name);
    weights += fmt::format("{}{}", comma, number(joint.weights[i]));
  }
  std::string toml = fmt::format("\n[[joint_set.joint]]\nname = \"{}\"\nparts = [{}]\n", joint.name, parts);
  if (joint.parts.empty()) return toml;
  toml += fmt::format("weights = [{}]\ndepth_offset = {}\n", weights, number(joint.depth_offset_m));
  if (joint.up_offset_m != 0.F) toml += fmt::format("up_offset = {}\n", number(joint.up_offset_m));
  return toml;
}

}  // namespace

std::string fitted_joints_toml(const Evaluation& evaluation) {
  const std::vector<JointSet> fitted =
      fit_joint_sets(of_all_sets(evaluation, &SetResult::known_people), evaluation.body);
  if (fitted.empty()) throw Error("no joints to fit: expected people found whose joints a set of the body has");
  std::string toml;
  for (const JointSet& set : fitted) {
    toml += fmt::format("{}[[joint_set]]\nname = \"{}\"\n", toml.empty() ? "" : "\n", set.name);
    for (const JointDefinition& joint : set.joints) toml += joint_toml(joint, evaluation.body);
  }
  return toml;
}

std::string fitted_distribution_toml(const Evaluation& evaluation) {
  const PartDistribution fitted = fit_distribution(of_all_sets(evaluation, &SetResult::known_people), evaluation.body);
  const auto numbers = [](const auto& values) {
    std::string text;
    for (const float value : values) text += fmt::format("{}{:.4f}", text.empty() ? "" : ", ", value);
    return text;
  };
  std::string toml = fmt::format("[distribution]\nfactors = {}\nnoise = {}\nconfidence = [{:.3f}, {:.3f}]\n",
                                 fitted.factors, fitted.noise_m, fitted.confidence_bias, fitted.confidence_slope);
  for (std::size_t p = 0; p < fitted.parts.size(); ++p) {
    const PartDistribution::Part& part = fitted.parts[p];
    toml += fmt::format("\n[[distribution.part]]\nname = \"{}\"\nmean = [{}]\nresidual = {:.4f}\n",
                        evaluation.body.parts[p].name, numbers(part.mean_m), part.residual_m);
    for (std::size_t axis = 0; axis < part.factors_m.size(); ++axis) {
      toml += fmt::format("{} = [{}]\n", "xyz"[axis], numbers(part.factors_m[axis]));
    }
  }
  return toml;
}

FittedJudge fit_judge(const Evaluation& evaluation) {
  FittedJudge fitted;
  std::vector<BoostSample> samples;
  for (const SetResult& set : evaluation.sets) {
    for (const JudgeSample& sample : set.samples) {
      samples.push_back({judge_features(sample.evidence), sample.person});
      ++(sample.person ? fitted.people : fitted.nobodies);
    }
  }
  const std::string none = "fitting the judge: the frames have no candidate that is known to be ";
  if (fitted.people == 0) throw Error(none + "a person");
  if (fitted.nobodies == 0) throw Error(none + "nobody");
  fitted.judge = boost_trees(samples, judge_signs(evaluation.body));
  fitted.judge.asks = judge_names(evaluation.body);
  return fitted;
}

FittedTrust fit_evaluation_trust(const Evaluation& evaluation) {
  FittedTrust fitted{fit_trust(of_all_sets(evaluation, &SetResult::trust_samples), builtin_trust()), ""};
  fitted.toml =
      "# How far joints of fitted bodies can be trusted (docs/tracking.md), by `vesalius evaluate --fit-trust`: the "
      "logit\n"
      "# of the probability that a joint lies within 10 cm is the bias and the sum of each signal times its weight.\n";
  for (const NamedSource& source : kJointSources) {
    const JointTrust& trust = fitted.fit.trust.*source.trust;
    fitted.toml += fmt::format("\n[{}]\nbias = {:.4f}\n", source.name, trust.bias);
    for (const TrustSignal& signal : kTrustSignals) {
      const float weight = trust.weights.*signal.value;
      if (weight != 0.F) fitted.toml += fmt::format("{} = {:.4f}\n", signal.name, weight);
    }
  }
  return fitted;
}

FittedStances fit_evaluation_stances(const Evaluation& evaluation) {
  FittedStances fitted{fit_stances(of_all_sets(evaluation, &SetResult::stance_samples), builtin_stances()), ""};
  fitted.toml =
      "# How probable stances are by one frame (docs/tracking.md), by `vesalius evaluate --fit-stances`: the logit is "
      "the\n"
      "# bias and the sum of each sign of the posture times its weight, or the weight of not knowing it. Heights are "
      "in\n"
      "# units of the person's stature.\n";
  for (const NamedRule& named : kStanceRules) {
    const StanceRule& rule = fitted.fit.model.*named.rule;
    fitted.toml += fmt::format("\n[{}]\nbias = {:.4f}\n", named.name, rule.bias);
    for (std::size_t i = 0; i < kStanceSigns.size(); ++i) {
      fitted.toml += fmt::format("{} = {:.4f}\n", kStanceSigns[i].name, rule.weights[i]);
      if (rule.unknown[i] != 0.F) fitted.toml += fmt::format("no_{} = {:.4f}\n", kStanceSigns[i].name, rule.unknown[i]);
    }
  }
  return fitted;
}

FittedContext fit_context(const Evaluation& evaluation) {
  FittedContext fitted;
  const std::vector<BoostSample> samples = of_all_sets(evaluation, &SetResult::context_samples);
  for (const BoostSample& sample : samples) ++(sample.positive ? fitted.bodies : fitted.others);
  const std::string none = "fitting the context: the frames have no pixel that may be a body and is known to be ";
  if (fitted.bodies == 0) throw Error(none + "one");
  if (fitted.others == 0) throw Error(none + "none");
  const std::vector<int> signs(samples.front().features.size(), 0);
  fitted.context = boost_trees(samples, signs, kContextOptions);
  fitted.context.asks = BodySurroundings::feature_names(evaluation.body);
  fitted.context.bias += float(std::log(kContextOdds));
  return fitted;
}

}  // namespace vesalius
