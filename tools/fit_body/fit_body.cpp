#include "fit_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "commands/synth/synth_recipe.h"
#include "dataset/labelled_truth.h"
#include "dataset/open_truth.h"
#include "evaluation/evaluate_set.h"
#include "evaluation/evaluation_joints.h"
#include "fitted_toml.h"
#include "learn/fit_tracks.h"
#include "synth/fit_flesh.h"
#include "vesalius/error.h"
#include "vesalius/model.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

Model model_of(const std::string& file) {
  Model model = load_model(file);
  model.body = with_evaluation_joints(model.body);
  return on_device(std::move(model));
}

FittedBodyFile fit_people(const FitTask& fit) {
  std::vector<KnownPerson> people;
  const BodyModel body = model_of(fit.models.front()).body;
  for (const std::string& file : fit.models) {
    const FrameScorer scorer(model_of(file), {.detect = {}, .joint_set = fit.joint_set});
    if (part_names_of(scorer.body()) != part_names_of(body)) {
      throw UsageError(fmt::format("{}: expected the parts of {}", file, fit.models.front()));
    }
    for (const std::string& source : fit.sources) {
      const auto frames = open_truth(source, fit.step);
      std::ranges::move(evaluate_set(*frames, {source, source, false, true}, scorer).known_people,
                        std::back_inserter(people));
    }
  }
  const std::string told = fmt::format("{} fitted to {} people\n", fit.what, people.size());
  return {fit.what == "joints" ? joints_toml(people, body) : parts_toml(people, body), told};
}

FittedBodyFile fit_tracks(const FitTask& fit) {
  const Model model = model_of(fit.models.front());
  const FrameScorer scorer(model, {});
  const SequenceTrackerFactory trackers = sequence_trackers(model, {});
  std::vector<TrustSample> joints;
  std::vector<StanceSample> postures;
  for (const std::string& source : fit.sources) {
    const auto one = [&](const std::string& folder) { return open_truth(folder, fit.step); };
    const auto open = [&] { return open_sequences(source, one); };
    SetResult set = evaluate_sequences(open, {source, source}, scorer, trackers,
                                       {fit.hidden, fit.what == "trust", fit.what == "stances"});
    std::ranges::move(set.trust_samples, std::back_inserter(joints));
    std::ranges::move(set.stance_samples, std::back_inserter(postures));
  }
  std::string told;
  if (fit.what == "trust") {
    const TrustFit fitted = fit_trust(joints, builtin_trust());
    for (const NamedSource& source : kJointSources) {
      const TrustAgreement& agreement = fitted.agreement[static_cast<std::size_t>(source.source)];
      if (agreement.samples == 0) continue;
      told += fmt::format(
          "trust in {} joints: {} of {} right; confidence and share right differ by {:.1f} %, were {:.1f} %{}\n",
          source.name, agreement.right, agreement.samples, 100.0 * agreement.after, 100.0 * agreement.before,
          agreement.fitted ? "" : " (too few to fit, left as it was)");
    }
    return {trust_toml(fitted.trust), told};
  }
  const StanceFit fitted = fit_stances(postures, builtin_stances());
  for (const StanceAgreement& agreement : fitted.agreement) {
    const double share = 100.0 / double(agreement.samples);
    told += fmt::format("stances fitted to {} frames of people {}: {:.1f} % right by one frame, were {:.1f} %\n",
                        agreement.samples, to_string(agreement.stance), share * double(agreement.right_after),
                        share * double(agreement.right_before));
  }
  return {stances_toml(fitted.model), told};
}

FittedBodyFile fit_flesh(const FitTask& fit) {
  const synth::Recipe recipe = cli::make_recipe({.file = fit.recipe});
  cli::LoadedAssets loaded = cli::load_assets(recipe, fit.assets);
  synth::FleshFitOptions options;
  options.bodies = std::min(options.bodies, recipe.body.count);
  const synth::Generator generator(recipe, std::move(loaded.assets), paper_body(), options.seed);
  return {synth::fitted_flesh_toml(generator, options), ""};
}

}  // namespace

FittedBodyFile fit_body(const FitTask& fit) {
  if (fit.what == "flesh") return fit_flesh(fit);
  const bool of_frames = fit.what == "joints" || fit.what == "parts";
  if (fit.models.empty() || (fit.models.size() > 1 && !of_frames)) {
    throw UsageError(fmt::format("{}: {} models, expected one", fit.what, fit.models.size()));
  }
  return of_frames ? fit_people(fit) : fit_tracks(fit);
}

}  // namespace vesalius
