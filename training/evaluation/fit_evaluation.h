#pragma once

#include <string>

#include "evaluation/evaluation.h"
#include "learn/fit_stances.h"
#include "learn/fit_trust.h"
#include "metrics/judge_samples.h"
#include "vesalius/forest/boosted_trees.h"

namespace vesalius {

/// Returns as TOML the joint sets of the body that the people kept for fitting have joints of (SetOptions::fit_joints),
/// fitted to them (fit_joint_sets). Throws Error if there was nothing to fit.
std::string fitted_joints_toml(const Evaluation& evaluation);

/// Returns the distribution of parts fitted to those people (fit_distribution) as TOML of a body model. Throws Error if
/// there are too few.
std::string fitted_distribution_toml(const Evaluation& evaluation);

/// A judge fitted to the candidates of all sets, each of which counts the same.
struct FittedJudge {
  BoostedTrees judge;
  long people = 0;
  long nobodies = 0;
};
/// Fits a judge for the evaluation's body. Throws Error unless there are people and nobodies among the candidates.
FittedJudge fit_judge(const Evaluation& evaluation);

/// A context of bodies fitted to the pixels of all labelled sets, each of which counts the same.
struct FittedContext {
  BoostedTrees context;
  long bodies = 0;
  long others = 0;
};
/// Fits a context for the evaluation's body to the samples that were kept (FrameScorer::Options::fit_context). Throws
/// Error unless there are pixels of people and others.
FittedContext fit_context(const Evaluation& evaluation);

/// A trust in fitted joints, fitted to the joints of all sets.
struct FittedTrust {
  TrustFit fit;
  std::string toml;  ///< data/bodies/flesh_trust.toml
};
/// Fits the trust, beginning with the built-in one. Throws Error as fit_trust does.
FittedTrust fit_evaluation_trust(const Evaluation& evaluation);

/// A model of stances fitted to the postures of all sets.
struct FittedStances {
  StanceFit fit;
  std::string toml;  ///< data/bodies/stances.toml
};
/// Fits the model. Throws Error as fit_stances does.
FittedStances fit_evaluation_stances(const Evaluation& evaluation);

}  // namespace vesalius
