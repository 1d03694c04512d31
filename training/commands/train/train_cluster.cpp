#include "commands/train/train_cluster.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>

#include "cluster/cluster_executor.h"
#include "commands/train/train_frames.h"
#include "commands/train/train_recipe.h"
#include "commands/train/train_session.h"
#include "console/interrupts.h"
#include "console/text_sink.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace vesalius::cli {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;
constexpr double kGiB = 1024.0 * kMiB;

/// Tells what each step of a training gave.
class StepTeller : public TrainObserver {
 public:
  explicit StepTeller(bool shown) : shown_(shown) {}
  void begin_round(const TreeRound& round, GrowProgress& /*progress*/) override {
    if (shown_) say(fmt::format("{}: {} of {} trees to grow", round.name, round.missing, round.trees));
  }
  void add_hard_negatives(std::size_t samples) override {
    if (shown_) say(fmt::format("{} hard negatives", samples));
  }
  bool end_leaf_round(int round, int rounds, double likelihood) override {
    if (shown_) say(fmt::format("leaves: round {} of {}, true classes get {:.3f}", round + 1, rounds, likelihood));
    return !interrupted();
  }

 private:
  bool shown_;
};

class ClusterRun {
 public:
  ClusterRun(const TrainRun& run, const TrainOptions& options, const TrainSources& sources,
             const TrainClusterFlags& flags)
      : run_(run), options_(options), sources_(sources), flags_(flags), inputs_(sources) {}

  void run() {
    EngineChoice choice = choose_engine(flags_.engine);
    choice.options.tell = show_jobs(run_.shown);
    choice.options.stopped = interrupted;
    const std::unique_ptr<Engine> engine = make_engine(flags_.engine, choice, run_.out + ".work/cluster");
    if (run_.shown) {
      for (const std::string& note : inputs_.notes()) say("note: " + note);
    }
    const std::optional<Forest> kept = run_.trees_of.empty() ? std::nullopt : std::optional(kept_trees(run_, inputs_));
    const FeatureConvention convention = kept ? kept->convention : training_convention(options_);
    TrainingSet background(inputs_.body(), convention, options_.sample, static_cast<std::uint64_t>(options_.grow.seed));
    const std::vector<BackgroundFacts> facts =
        inputs_.read_backgrounds([&](const LabelledFrame& frame) { background.add(frame); });
    Forest forest = background.untrained_forest();
    forest.recipe = train_recipe(options_, inputs_, facts, kept ? &*kept : nullptr);
    session_.emplace(run_.out + ".work", forest, run_.restart);
    if (run_.restart) ClusterExecutor::clear(*engine);
    try {
      train(*engine, choice, background, kept, std::move(forest));
    } catch (const Interrupted&) {
      throw Error(
          fmt::format("interrupted, finished jobs are in {}: the same command goes on", engine->store().place()));
    }
  }

 private:
  void train(Engine& engine, const EngineChoice& choice, const TrainingSet& background,
             const std::optional<Forest>& kept, Forest forest) {
    const auto start = std::chrono::steady_clock::now();
    ClusterTraining training{.forest = forest,
                             .options = options_,
                             .source = frames_text(sources_, inputs_),
                             .frames = static_cast<std::uint64_t>(inputs_.frames())};
    if (background.frames().size() > 0) training.backgrounds.push_back(&background);
    ClusterExecutor executor(engine, std::move(training),
                             {.shard_frames = static_cast<std::uint64_t>(flags_.shard_frames),
                              .map_tasks = choice.options.map_tasks,
                              .task_memory = static_cast<std::uint64_t>(flags_.task_memory_gib * kGiB)});
    expect_people(executor);
    StepTeller observer(run_.shown);
    if (kept) {
      const std::string recipe = forest.recipe;
      forest = *kept;
      forest.recipe = recipe;
      if (options_.hard_trees > 0) {
        observer.add_hard_negatives(vesalius::add_hard_negatives(executor, forest, options_.sample));
      }
      relearn_leaves(executor, forest, options_.leaves, *session_, observer);
    } else {
      forest = train_forest(executor, std::move(forest), options_, *session_, observer);
    }
    save_model(forest, run_.out);
    ClusterExecutor::clear(engine);
    session_->remove();
    if (!run_.shown) return;
    say(fmt::format("{}: {} trees, {:.2f} MiB, trained in {:.1f} s", run_.out, forest.trees.size(),
                    double(std::filesystem::file_size(run_.out)) / kMiB,
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()));
  }

  void expect_people(const ClusterExecutor& executor) const {
    const PreparedShard total = executor.total();
    const auto parts = static_cast<std::ptrdiff_t>(inputs_.body().part_count());
    const auto end = total.samples.pixels.begin() + parts;
    if (std::none_of(total.samples.pixels.begin(), end, [](std::uint64_t pixels) { return pixels > 0; })) {
      throw Error(fmt::format("no person in any of {} frames, expected some to learn from", total.frames));
    }
    if (!run_.shown) return;
    std::int64_t samples = 0;
    for (const std::int64_t of_class : total.samples.samples) samples += of_class;
    say(fmt::format("{} frames in {} shards, {:.2f} million samples, {:.2f} GiB", total.frames, executor.shards(),
                    double(samples) * 1e-6, double(total.bytes) / kGiB));
  }

  const TrainRun& run_;
  const TrainOptions& options_;
  const TrainSources& sources_;
  const TrainClusterFlags& flags_;
  TrainInputs inputs_;
  std::optional<TrainSession> session_;
};

}  // namespace

void train_on_cluster(const TrainRun& run, const TrainOptions& options, const TrainSources& sources,
                      const TrainClusterFlags& flags) {
  ClusterRun(run, options, sources, flags).run();
}

}  // namespace vesalius::cli
