#include "commands/train/train_curves.h"

#include <algorithm>
#include <chrono>
#include <iterator>

#include "commands/train/grow_display.h"
#include "console/interrupts.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

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
