// Trains a small forest on rendered people, writes it and measures its labels on others: OUT.forest.

#include <cstdint>
#include <iostream>
#include <utility>
#include <vector>

#include "eval/metric_table.h"
#include "eval/score_frame.h"
#include "io/model/model_file.h"
#include "synth/generate.h"
#include "train/grow_forest.h"
#include "vesalius/forest/make_labeller.h"
#include "vesalius/vesalius.h"

namespace {

/// One person in each frame of a small camera.
vesalius::synth::Generator rendered(std::uint64_t seed) {
  vesalius::synth::Recipe recipe;
  recipe.people = {.none = 0.F, .one = 1.F, .two = 0.F, .three = 0.F, .four = 0.F};
  recipe.body.count = 4;
  recipe.sensor.width = 128;
  recipe.sensor.height = 96;
  return {recipe, {}, vesalius::paper_body(), seed};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const vesalius::synth::Generator known = rendered(1);
  std::vector<vesalius::LabelledFrame> frames;
  for (std::uint64_t i = 0; i < 40; ++i) frames.push_back(known.frame(i));

  vesalius::TrainOptions options;
  options.trees = 2;
  options.hard_trees = 0;
  options.grow.leaf.max_depth = 12;
  const vesalius::Forest forest = vesalius::grow_forest(frames, vesalius::paper_body(), options);
  vesalius::save_model(forest, argv[1]);

  vesalius::FrameScorer::Options judged;
  judged.labels_only = true;
  const vesalius::FrameScorer scorer(vesalius::make_labeller(forest), judged);
  const vesalius::synth::Generator unknown = rendered(2);
  vesalius::MetricTable metrics;
  for (std::uint64_t i = 0; i < 8; ++i) {
    vesalius::LabelledFrame labelled = unknown.frame(i);
    vesalius::TrueFrame frame{std::move(labelled.frame), {}};
    frame.truth.labels = std::move(labelled.labels);
    frame.truth.person = std::move(labelled.person);
    metrics.add(i, scorer.score(std::move(frame), false).terms);
  }
  for (const vesalius::Estimate& estimate : metrics.estimates()) {
    if (estimate.id.metric == vesalius::Metric::pixel_mean_recall_inside) {
      std::cout << "recall among parts: " << text_with_interval(estimate) << '\n';
    }
  }
}
