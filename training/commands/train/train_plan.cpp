#include "commands/train/train_plan.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "commands/train/train_report.h"
#include "train/local_executor.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
constexpr double kUsedShare = 0.8;  ///< share of the machine's memory; other programs need some too
constexpr int kFewestMeasured = 4, kMostMeasured = 50, kOneOf = 30;  ///< frames
constexpr int kUnknownBackgrounds = 1000;  ///< frames of a source that does not say how many it has
constexpr int kEmptyPool = 4;              ///< times as many pixels to search for hard negatives (SampleOptions)
constexpr int kPilotTree = 2000;           ///< its number
constexpr double kMargin = 1.1;            ///< by which the other frames may take more
constexpr double kGrowing = 2.0;           ///< largest ratio of a vector's capacity to its size

// Bytes of a sample while a tree grows: its node, row, side, label and number; and the values of its candidates.
constexpr double kGrowBytes = 14.0, kRowBytes = 2.0 * kBlockCandidates;
// Bytes of a node while a tree grows; of a leaf's logit while it is learned: now, at first, gradient, and weight.
constexpr double kNodeBytes = kGrowing * (sizeof(GrownNode) + sizeof(TreeNode)), kLogitBytes = 12.0;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// What all frames of a training take, of which some were measured.
struct Load {
  double reading_s = 0.0, depth_bytes = 0.0, samples = 0.0, pool = 0.0;
};

/// Adds some frames to the set. A background counts with the most that its frames may take.
Load measure(const TrainInputs& inputs, const SampleOptions& options, TrainingSet& set) {
  const auto frames = double(inputs.frames());
  const int step = std::max(1, int(frames / std::clamp(frames / kOneOf, kFewestMeasured * 1.0, kMostMeasured * 1.0)));
  const Clock::time_point start = Clock::now();
  inputs.read({1.0, [&](int i) { return i % step == 0; }}, [&](const LabelledFrame& frame) { set.add(frame); });
  const double times = frames / double(set.frames().size());
  Load load{times * seconds_since(start), times * double(set.frames().bytes()), times * double(set.samples().size()),
            times * double(set.contents().pool.size())};
  for (const TrainBackground& background : inputs.backgrounds()) {
    const int count = background.frames >= 0 ? background.frames : kUnknownBackgrounds;
    load.depth_bytes += double(FrameStore::most_frame_bytes(background.width, background.height)) * count;
    load.samples += double(options.background_share) * options.pixels_per_frame * count;
    load.pool += double(kEmptyPool * options.hard_pool) * count;
  }
  return load;
}

/// Times of a tree and of a round of learning its leaves, for as many samples as a training has.
struct Pilot {
  Forest forest;
  double tree_s = 0.0, leaves_s = 0.0, evaluations = 0.0, leaves = 0.0;
};

/// Grows a tree. A node looks at no more than `split_pixels` samples, so every sample is looked at about equally often
/// however many there are.
Pilot grow_pilot(TrainingSet& set, double samples, const TrainOptions& options) {
  if (set.samples().empty()) return {};
  const double times = samples / double(set.samples().size());
  GrowProgress progress;
  Clock::time_point start = Clock::now();
  Forest forest = set.untrained_forest();
  forest.trees = {grow_tree(set, options.grow, kPilotTree, &progress)};
  Pilot pilot{
      .forest = forest,
      .tree_s = times * seconds_since(start),
      .evaluations = times * double(progress.evaluations),
      .leaves = std::min(times * double(forest.trees[0].leaves.size()), std::ldexp(1.0, options.grow.leaf.max_depth))};
  if (options.leaves.rounds == 0 || !forest.has_background) return pilot;
  start = Clock::now();
  LeafLearningOptions one = options.leaves;
  one.rounds = 1;
  LocalExecutor executor({&set});
  MemoryTreeStore store;
  const LogitLayout layout(forest.body, forest.has_background, one.headings);
  learn_leaves(*executor.begin_leaves(forest, layout), forest, layout, one, store, [](int, double) { return true; });
  pilot.leaves_s = times * seconds_since(start);
  return pilot;
}

/// Returns the peak memory in bytes that the program has taken so far, for its libraries and open sources.
double own_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) * 1024.0;
}

}  // namespace

std::string duration(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.0f} s", seconds);
  return seconds < 7200.0 ? fmt::format("{:.0f} min", seconds / 60.0) : fmt::format("{:.1f} h", seconds / 3600.0);
}

std::string TrainPlan::text() const {
  return steps + fmt::format("time          {:.0f} s in all ({})\nmemory        at most {:.2f} GiB\n", seconds,
                             duration(seconds), double(bytes) / kGiB);
}

std::uint64_t default_memory() {
  const auto pages = double(::sysconf(_SC_PHYS_PAGES));
  const auto page_bytes = double(::sysconf(_SC_PAGESIZE));
  return static_cast<std::uint64_t>(kUsedShare * pages * page_bytes);
}

TrainPlan plan_training(const TrainInputs& inputs, const TrainOptions& options, bool curves, std::uint64_t limit) {
  SampleOptions drawn = options.sample;
  drawn.held_out_share = 0.F;
  TrainingSet set(inputs.body(), training_convention(options), drawn, static_cast<std::uint64_t>(options.grow.seed));
  const Load load = measure(inputs, drawn, set);
  const double own = own_memory();
  const int hard_trees = set.has_background() ? options.hard_trees : 0;
  const double hard = double(drawn.background_share * drawn.hard_share) * load.samples;
  const double samples = load.samples + (hard_trees > 0 ? std::min(hard, load.pool) : 0.0);
  const Pilot pilot = grow_pilot(set, samples, options);

  const LogitLayout layout(inputs.body(), set.has_background(), options.leaves.headings);
  const double set_bytes = load.depth_bytes + kGrowing * (samples + load.pool) * sizeof(TrainingSample);
  const double tree_bytes =
      samples * kGrowBytes + pilot.leaves * kNodeBytes + std::min(samples * kRowBytes, double(options.grow.row_bytes));
  const double leaf_bytes =
      pilot.leaves_s > 0.0 ? options.trees * (4.0 * samples + pilot.leaves * layout.size() * kLogitBytes) : 0.0;
  const auto bytes = [&](int trees) {
    const double frames = set_bytes * (curves ? 1.0 + kCurveFrames : 1.0);
    return static_cast<std::uint64_t>(own + kMargin * (frames + std::max(trees * tree_bytes, leaf_bytes)));
  };
  if (bytes(1) > limit) {
    const double needed = double(bytes(1)) / kGiB;
    throw Error(fmt::format(
        "training on {} frames with {} pixels each takes about {:.2f} GiB, --memory allows {:.2f}: expected --memory "
        "{:.1f}, fewer frames (--count), fewer --pixels, or --on, which divides them among machines",
        inputs.frames(), drawn.pixels_per_frame, needed, double(limit) / kGiB, std::ceil(10.0 * needed) / 10.0));
  }
  TrainPlan plan;
  const int most = std::min(thread_count(), std::max(options.trees, 1));
  while (plan.trees_at_once < most && bytes(plan.trees_at_once + 1) <= limit) ++plan.trees_at_once;
  plan.bytes = bytes(plan.trees_at_once);
  const int trees = options.trees + hard_trees;
  const double leaves_s = pilot.leaves_s * options.leaves.rounds * options.trees;
  plan.seconds = load.reading_s + trees * pilot.tree_s + leaves_s;
  plan.reading_s = load.reading_s;
  plan.pilot = pilot.forest;
  plan.steps =
      fmt::format("frames        {} in {}, {:.1f} a second\n", inputs.frames(), duration(load.reading_s),
                  double(inputs.frames()) / load.reading_s) +
      fmt::format("samples       {:.2f} million\n", samples * 1e-6) +
      fmt::format("evaluations   {:.1f} thousand million, {:.0f} million a second on {} threads\n",
                  trees * pilot.evaluations * 1e-9, pilot.evaluations / std::max(pilot.tree_s, 1e-9) * 1e-6,
                  thread_count()) +
      fmt::format("trees         {} in {}, {} at a time{}\n", trees, duration(trees * pilot.tree_s), plan.trees_at_once,
                  leaves_s > 0.0 ? fmt::format("; their leaves in {}", duration(leaves_s)) : "");
  return plan;
}

}  // namespace vesalius::cli
