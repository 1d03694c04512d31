#include "evaluation/fit_evaluation.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "eval/median.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

/// Rounds a weight to hundredths, which changes no score by more than a quarter of a hundredth.
float rounded(float weight) { return std::round(weight * 100.F) / 100.F; }

/// Returns a joint whose depth offset is the median of the samples, or the joint's own if there are none.
std::string joint_toml(const JointDefinition& joint, const std::vector<double>& samples_m, const BodyModel& body) {
  std::string parts, weights;
  for (std::size_t i = 0; i < joint.parts.size(); ++i) {
    const char* comma = i > 0 ? ", " : "";
    parts += fmt::format("{}\"{}\"", comma, body.parts[joint.parts[i]].name);
    weights += fmt::format("{}{}", comma, joint.weights[i]);
  }
  std::string toml = fmt::format("\n[[joint_set.joint]]\nname = \"{}\"\nparts = [{}]\n", joint.name, parts);
  if (joint.parts.empty()) return toml;
  const double offset_m = samples_m.empty() ? static_cast<double>(joint.depth_offset_m) : median(samples_m);
  return toml + fmt::format("weights = [{}]\ndepth_offset = {:.3f}\n", weights, offset_m);
}

}  // namespace

std::string fitted_joints_toml(const Evaluation& evaluation) {
  std::map<std::string, std::map<std::string, std::vector<double>>> samples_m;
  for (const SetResult& set : evaluation.sets) {
    for (const auto& [joint_set, joints] : set.offsets_m) {
      for (const auto& [joint, offsets] : joints) {
        auto& all = samples_m[joint_set][joint];
        all.insert(all.end(), offsets.begin(), offsets.end());
      }
    }
  }
  if (samples_m.empty()) throw Error("no joints to fit: expected a source with joints that a set of the body has");
  std::string toml;
  for (const JointSet& set : evaluation.body.joint_sets) {
    if (!samples_m.contains(set.name)) continue;
    toml += fmt::format("[[joint_set]]\nname = \"{}\"\n", set.name);
    for (const JointDefinition& joint : set.joints)
      toml += joint_toml(joint, samples_m[set.name][joint.name], evaluation.body);
  }
  return toml;
}

FittedOptions fit_score_options(const Evaluation& evaluation) {
  std::vector<std::vector<ScoreSample>> sets;
  for (const SetResult& set : evaluation.sets) sets.push_back(set.samples);
  FittedOptions fitted{evaluation.options, {}};
  ScoreOptions& score = evaluation.has_background ? fitted.options.score : fitted.options.score_without_background;
  fitted.fit = fit_score(sets, score);
  score = fitted.fit.options;
  for (const EvidenceWeight& piece : kEvidenceWeights) score.*piece.weight = rounded(score.*piece.weight);
  score.bias = rounded(score.bias);
  return fitted;
}

}  // namespace vesalius
