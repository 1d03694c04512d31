#include "commands/train/train_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>

#include "commands/train/grow_display.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

std::string share_text(double share) { return fmt::format("{:.3f}", share); }

std::vector<std::string> class_names(const TrainingSet& set) {
  std::vector<std::string> names;
  for (const BodyPart& part : set.body().parts) names.push_back(part.name);
  if (set.has_background()) names.emplace_back("background");
  return names;
}

/// Plots both accuracies against numbers that begin with `first`, 0 or 1.
LinePlot accuracy_plot(const std::string& caption, const std::string& x_label, const std::vector<AccuracyPoint>& points,
                       int first) {
  LinePlot plot{caption, x_label, "mean recall of the parts", {{"among parts", {}}, {"background a rival", {}}}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = double(i) + first;
    plot.series[0].points.emplace_back(x, points[i].parts_only);
    plot.series[1].points.emplace_back(x, points[i].with_background);
  }
  // The range is given because a single point would span none.
  plot.x_range = {double(first), std::max(double(points.size()) - 1, 1.0) + first};
  plot.y_range = {0.0, 1.0};
  return plot;
}

void add_summary(Document& document, const Forest& forest, const TrainingSet& set, const TrainFigures& figures) {
  const double core_s = figures.grown.seconds * figures.threads;
  const auto evaluations = double(figures.grown.evaluations);
  std::vector<std::vector<std::string>> rows = {
      {"Accuracy among parts", share_text(figures.accuracy.parts_only())},
      {"Accuracy, background a rival", share_text(figures.accuracy.with_background())},
      {"Frames", fmt::format("{}", set.frames().size())},
      {"Samples learned from", fmt::format("{}", set.samples().size())},
      {"of them hard negatives", fmt::format("{}", figures.grown.hard_negatives)},
      {"Samples held out", fmt::format("{}", set.held_out().size())},
      {"Frames and samples in memory, MiB", fmt::format("{:.0f}", double(set.bytes()) / kMiB)},
      {"Reading or rendering, s", fmt::format("{:.1f}", figures.reading_s)},
      {"Growing, s", fmt::format("{:.1f}", figures.grown.seconds)},
      {"Threads", fmt::format("{}", figures.threads)},
      {"Million evaluations per core-second", core_s > 0.0 ? fmt::format("{:.1f}", evaluations / core_s * 1e-6) : ""},
      {"Model, MiB", fmt::format("{:.2f}", double(figures.model_bytes) / kMiB)},
      {"Trees", fmt::format("{}", forest.trees.size())}};
  document.table({"", ""}, rows);
  if (figures.grown.resumed > 0) {
    document.paragraph(
        fmt::format("{} trees of both rounds are of an earlier run; times and evaluations are those of "
                    "the last one.",
                    figures.grown.resumed));
  }
  document.paragraph(
      "Accuracy is the mean recall of the body parts on held-out samples, which were drawn as those to learn from: "
      "half "
      "of them balanced over the parts. It compares forests on the same samples and is no figure over all pixels.");
}

void add_trees(Document& document, const Forest& forest, const TrainFigures& figures) {
  document.heading(2, "Trees");
  document.plot(accuracy_plot("Accuracy of the first trees together", "trees", figures.by_trees, 1));
  std::vector<std::vector<std::string>> rows;
  for (std::size_t t = 0; t < forest.trees.size(); ++t) {
    const Tree& tree = forest.trees[t];
    const AccuracyPoint& point = figures.by_trees[t];
    rows.push_back({fmt::format("{}", t + 1), fmt::format("{}", depth(tree)), fmt::format("{}", tree.nodes.size()),
                    fmt::format("{}", tree.leaves.size()), share_text(point.parts_only),
                    share_text(point.with_background)});
  }
  document.table({"Trees", "Depth", "Nodes", "Leaves", "Among parts", "Background a rival"}, rows);
}

void add_levels(Document& document, const TrainFigures& figures) {
  document.heading(2, "Levels");
  document.plot(
      accuracy_plot("Accuracy of the forest cut at a level, inner nodes answering with the samples that pass them",
                    "level", figures.by_level, 0));
  std::vector<std::vector<std::string>> rows;
  for (std::size_t level = 0; level < figures.by_level.size(); ++level) {
    rows.push_back({fmt::format("{}", level), share_text(figures.by_level[level].parts_only),
                    share_text(figures.by_level[level].with_background)});
  }
  document.table({"Level", "Among parts", "Background a rival"}, rows);
}

/// Returns the shares of the samples of each class that were given each class.
MatrixPlot confusion_plot(const Confusion& confusion, const std::vector<std::string>& names) {
  MatrixPlot plot{"Confusion matrix: percent of a true class (row) that were given a class (column)", names, {}};
  for (int truth = 0; truth < confusion.classes; ++truth) {
    std::vector<double>& row = plot.shares.emplace_back();
    const auto sum = double(std::max(confusion.row_sum(truth), std::uint64_t{1}));
    for (int given = 0; given < confusion.classes; ++given) {
      row.push_back(double(confusion.at(truth, given)) / sum);
    }
  }
  return plot;
}

void add_classes(Document& document, const TrainingSet& set, const TrainFigures& figures) {
  const std::vector<std::string> names = class_names(set);
  document.heading(2, "Classes");
  document.matrix(confusion_plot(figures.accuracy.all, names));
  std::vector<std::uint64_t> samples(names.size(), 0);
  for (const TrainingSample& sample : set.samples()) ++samples[sample.label];
  std::vector<std::vector<std::string>> rows;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const int index = int(c);
    const bool part = index < set.body().part_count();
    rows.push_back({names[c], fmt::format("{}", set.class_pixels()[c]), fmt::format("{}", samples[c]),
                    fmt::format("{}", figures.accuracy.all.row_sum(index)),
                    part ? share_text(figures.accuracy.parts.recall(index)) : "",
                    share_text(figures.accuracy.all.recall(index))});
  }
  document.table({"Class", "Pixels", "Samples", "Held out", "Recall among parts", "Recall"}, rows);
}

/// Plots both accuracies against `x_of`, for the points that differ from the largest run in nothing else.
template <class XOf>
LinePlot curve_plot(const std::string& caption, const std::string& x_label, const std::vector<CurvePoint>& curve,
                    const XOf& x_of) {
  LinePlot plot{caption, x_label, "mean recall of the parts", {{"among parts", {}}, {"background a rival", {}}}};
  plot.log_x = true;
  plot.y_range = {0.0, 1.0};
  for (const CurvePoint& point : curve) {
    const auto x = double(x_of(point));
    plot.series[0].points.emplace_back(x, point.accuracy.parts_only);
    plot.series[1].points.emplace_back(x, point.accuracy.with_background);
  }
  return plot;
}

void add_curves(Document& document, const std::vector<CurvePoint>& points) {
  if (points.empty()) return;
  document.heading(2, "Curves");
  std::vector<CurvePoint> by_frames, by_candidates;
  for (const CurvePoint& point : points) {
    if (point.candidates == points.front().candidates) by_frames.push_back(point);
    if (point.frame_share >= 1.0) by_candidates.push_back(point);
  }
  document.plot(curve_plot("Accuracy against frames learned from", "frames", by_frames,
                           [](const CurvePoint& p) { return p.frames; }));
  document.plot(curve_plot("Accuracy against candidates of a node", "candidates", by_candidates,
                           [](const CurvePoint& p) { return p.candidates; }));
  std::vector<std::vector<std::string>> rows;
  rows.reserve(points.size());
  for (const CurvePoint& point : points) {
    rows.push_back({fmt::format("{}", point.frames), fmt::format("{}", point.candidates),
                    fmt::format("{}", point.trees), share_text(point.accuracy.parts_only),
                    share_text(point.accuracy.with_background), fmt::format("{:.1f}", point.seconds)});
  }
  document.table({"Frames", "Candidates", "Trees", "Among parts", "Background a rival", "Growing, s"}, rows);
}

constexpr int kTrees = 2;

/// Returns for each frame of the set whether it is held out.
std::vector<bool> held_out_frames(const TrainingSet& set) {
  std::vector<bool> held_out(set.frames().size(), false);
  for (const TrainingSample& sample : set.held_out()) held_out[sample.frame] = true;
  return held_out;
}

/// Returns a set of the first `share` of the frames that `set` learns from.
TrainingSet smaller_set(const TrainInputs& inputs, const TrainingSet& set, std::size_t backgrounds,
                        const TrainOptions& options, double share) {
  SampleOptions sample = options.sample;
  sample.held_out_share = 0.F;
  sample.hard_pool = 0;
  TrainingSet fewer(set.body(), set.convention(), sample, static_cast<std::uint64_t>(options.grow.seed));
  const std::vector<bool> held_out = held_out_frames(set);
  std::size_t index = 0;
  inputs.read_backgrounds([&](const LabelledFrame& frame) {
    const bool early = double(index) < share * double(backgrounds);
    if (early && !held_out[index]) fewer.add(frame);
    ++index;
  });
  const auto wanted = [&](int i) { return !held_out[backgrounds + i]; };
  inputs.read({share, wanted}, [&](const LabelledFrame& frame) { fewer.add(frame); });
  return fewer;
}

CurvePoint measure(const TrainingSet& learn, const TrainingSet& judge, TrainOptions options, bool shown) {
  using Clock = std::chrono::steady_clock;
  GrowProgress progress;
  HeldOutVotes votes(judge);
  const Clock::time_point start = Clock::now();
  {
    GrowDisplay display("curves", learn, kTrees, options.grow.leaf.max_depth, progress, shown);
    for (int t = 0; t < kTrees; ++t) votes.add(grow_tree(learn, options.grow, t, &progress));
  }
  CurvePoint point;
  point.candidates = options.grow.split.candidates;
  point.trees = kTrees;
  point.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const SampleAccuracy accuracy = votes.accuracy();
  point.accuracy = {accuracy.with_background(), accuracy.parts_only()};
  return point;
}

}  // namespace

Document train_report(const Forest& forest, const TrainingSet& set, const TrainFigures& figures) {
  Document document(fmt::format("Training of {}", figures.model));
  add_summary(document, forest, set, figures);
  add_trees(document, forest, figures);
  add_levels(document, figures);
  add_classes(document, set, figures);
  add_curves(document, figures.curves);
  document.heading(2, "Recipe");
  document.preformatted(forest.recipe);
  return document;
}

std::vector<CurvePoint> train_curves(const TrainInputs& inputs, const TrainingSet& set, std::size_t backgrounds,
                                     const TrainOptions& options, bool shown) {
  std::vector<CurvePoint> points;
  const auto add = [&](const TrainingSet& learn, const TrainOptions& with, double share) {
    CurvePoint point = measure(learn, set, with, shown);
    point.frame_share = share;
    const std::vector<bool> held_out = held_out_frames(set);
    const auto kept_back = share < 1.0 ? 0 : std::ranges::count(held_out, true);
    point.frames = static_cast<std::int64_t>(learn.frames().size()) - kept_back;
    points.push_back(point);
  };
  for (const double share : {1.0 / 16, kCurveFrames}) {
    add(smaller_set(inputs, set, backgrounds, options, share), options, share);
  }
  add(set, options, 1.0);
  for (const double factor : {0.25, 4.0}) {
    TrainOptions other = options;
    other.grow.split.candidates = std::max(1, int(options.grow.split.candidates * factor));
    add(set, other, 1.0);
  }
  return points;
}

}  // namespace vesalius::cli
