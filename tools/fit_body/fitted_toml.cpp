#include "fitted_toml.h"

#include <fmt/format.h>

#include "learn/fit_distribution.h"
#include "learn/fit_joints.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

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

std::string joints_toml(const std::vector<KnownPerson>& people, const BodyModel& body) {
  const std::vector<JointSet> fitted = fit_joint_sets(people, body);
  if (fitted.empty()) throw Error("no joints to fit: expected people found whose joints a set of the body has");
  std::string toml;
  for (const JointSet& set : fitted) {
    toml += fmt::format("{}[[joint_set]]\nname = \"{}\"\n", toml.empty() ? "" : "\n", set.name);
    for (const JointDefinition& joint : set.joints) toml += joint_toml(joint, body);
  }
  return toml;
}

std::string parts_toml(const std::vector<KnownPerson>& people, const BodyModel& body) {
  const PartDistribution fitted = fit_distribution(people, body);
  const auto numbers = [](const auto& values) {
    std::string text;
    for (const float value : values) text += fmt::format("{}{:.4f}", text.empty() ? "" : ", ", value);
    return text;
  };
  const auto confidence = [](const char* key, const PartDistribution::Confidence& of) {
    return fmt::format("{} = [{:.3f}, {:.3f}]\n", key, of.bias, of.slope);
  };
  std::string toml = fmt::format("[distribution]\nfactors = {}\nnoise = {}\n", fitted.factors, fitted.noise_m) +
                     confidence("confidence", fitted.confidence);
  if (fitted.voted_confidence) toml += confidence("voted_confidence", *fitted.voted_confidence);
  for (std::size_t p = 0; p < fitted.parts.size(); ++p) {
    const PartDistribution::Part& part = fitted.parts[p];
    toml += fmt::format("\n[[distribution.part]]\nname = \"{}\"\nmean = [{}]\nresidual = {:.4f}\ndepth = {:.4f}\n",
                        body.parts[p].name, numbers(part.mean_m), part.residual_m, part.depth_m);
    if (part.observed_m > 0.F) toml += fmt::format("observed = {:.2f}\n", part.observed_m);
    for (std::size_t axis = 0; axis < part.factors_m.size(); ++axis) {
      toml += fmt::format("{} = [{}]\n", "xyz"[axis], numbers(part.factors_m[axis]));
    }
  }
  return toml;
}

std::string trust_toml(const BodyTrust& fitted) {
  std::string toml =
      "# How far joints of fitted bodies can be trusted (docs/tracking.md), by `vesalius_fit_body trust`: the logit\n"
      "# of the probability that a joint lies within 10 cm is the bias and the sum of each signal times its weight.\n";
  for (const NamedSource& source : kJointSources) {
    const JointTrust& trust = fitted.*source.trust;
    toml += fmt::format("\n[{}]\nbias = {:.4f}\n", source.name, trust.bias);
    for (const TrustSignal& signal : kTrustSignals) {
      const float weight = trust.weights.*signal.value;
      if (weight != 0.F) toml += fmt::format("{} = {:.4f}\n", signal.name, weight);
    }
  }
  return toml;
}

std::string stances_toml(const StanceModel& fitted) {
  std::string toml =
      "# How probable stances are by one frame (docs/tracking.md), by `vesalius_fit_body stances`: the logit is the\n"
      "# bias and the sum of each sign of the posture times its weight, or the weight of not knowing it. Heights are in\n"
      "# units of the person's stature.\n";
  for (const NamedRule& named : kStanceRules) {
    const StanceRule& rule = fitted.*named.rule;
    toml += fmt::format("\n[{}]\nbias = {:.4f}\n", named.name, rule.bias);
    for (std::size_t i = 0; i < kStanceSigns.size(); ++i) {
      toml += fmt::format("{} = {:.4f}\n", kStanceSigns[i].name, rule.weights[i]);
      if (rule.unknown[i] != 0.F) toml += fmt::format("no_{} = {:.4f}\n", kStanceSigns[i].name, rule.unknown[i]);
    }
  }
  return toml;
}

}  // namespace vesalius
