// Makes data/models/default_judge.toml: see data/models/README.md.

#include <CLI/CLI.hpp>
#include <iostream>

#include "dataset/open_truth.h"
#include "evaluation/evaluate_set.h"
#include "io/files/atomic_file.h"
#include "io/model/model_file.h"
#include "learn/boost_trees.h"
#include "vesalius/base/error.h"
#include "vesalius/default_judge.h"
#include "vesalius/model.h"

namespace vesalius {
namespace {

/// Returns the candidates of a forest without its judge in the frames of a source, with the evidence of any body.
std::vector<BoostSample> samples_of(const std::string& model, const std::string& source) {
  Model loaded = load_model(model);
  loaded.judge = {};
  const FrameScorer scorer(std::move(loaded), {});
  const SetResult set = evaluate_set(*open_truth(source), {source, source}, scorer);
  std::vector<BoostSample> samples;
  long people = 0;
  for (const JudgeSample& sample : set.samples) {
    std::vector<float> features = judge_features(sample.evidence);
    features.resize(kJudgedEvidence.size());
    samples.push_back({std::move(features), sample.person});
    people += sample.person ? 1 : 0;
  }
  std::cout << model << ", " << source << ": " << people << " people and " << std::ssize(samples) - people << " others"
            << std::endl;
  return samples;
}

int run(int argc, char** argv) {
  CLI::App app("Makes the judge of forests that have none, from what several forests propose in labelled frames");
  std::string out;
  std::vector<std::string> models, sources;
  BoostOptions options{.trees = 80, .rate = 0.15};
  app.add_option("OUT", out, "File to write")->required();
  app.add_option("--models", models, "Forests; their judges are left out")->required();
  app.add_option("--frames", sources, "Labelled frames that none of them learned from")->required();
  app.add_option("--trees", options.trees);
  app.add_option("--rate", options.rate);
  app.add_option("--least-samples", options.least_samples);
  CLI11_PARSE(app, argc, argv);
  std::vector<BoostSample> samples;
  for (const std::string& model : models) {
    for (const std::string& source : sources) std::ranges::move(samples_of(model, source), std::back_inserter(samples));
  }
  std::vector<int> signs;
  for (const JudgedEvidence& kind : kJudgedEvidence) signs.push_back(kind.sign);
  BoostedTrees judge = boost_trees(samples, signs, options);
  for (const JudgedEvidence& kind : kJudgedEvidence) judge.asks.emplace_back(kind.name);
  write_file_atomically(
      out, "# The judge of forests that have none: data/models/README.md says how it was made.\n" + to_toml(judge));
  return 0;
}

}  // namespace
}  // namespace vesalius

int main(int argc, char** argv) {
  try {
    return vesalius::run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << "vesalius_make_judge: " << e.what() << '\n';
    return 1;
  }
}
