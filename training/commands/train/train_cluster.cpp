#include "commands/train/train_cluster.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "cluster/cluster_executor.h"
#include "commands/cluster/cluster_flags.h"
#include "commands/train/train_recipe.h"
#include "commands/train/train_session.h"
#include "console/interrupts.h"
#include "console/text_sink.h"
#include "folders/owned_folder.h"
#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "io/files/plain_text.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

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

std::string hash_text(const TrainInput& input) { return fmt::format("{:016x}", input.hash); }

TrainSources sources_of(const Json& json, const TemporaryFolder& texts) {
  const auto put = [&](const std::string& name, const Json& text) {
    write_file_atomically(texts.path(name), text.get<std::string>());
    return texts.path(name);
  };
  TrainSources sources;
  sources.data = json.at("data").get<std::vector<std::string>>();
  int number = 0;
  for (const Json& recipe : json.at("recipes")) {
    const std::string name = fs::path(recipe.at("name").get<std::string>()).filename().string();
    sources.recipes.push_back(put(fmt::format("{}-{}", ++number, name), recipe.at("text")));
  }
  if (!json.at("body").get<std::string>().empty()) sources.body = put("body.toml", json.at("body"));
  sources.count = json.at("count").get<int>();
  sources.render_seed = json.at("seed").get<std::uint64_t>();
  sources.assets.motions = json.at("motions").get<std::string>();
  sources.assets.folder = json.at("assets").get<std::string>();
  return sources;
}

/// Returns the sources of frames as text for the tasks of a cluster. Recipes and body are in it; datasets and motions
/// are named by absolute paths and must be there on every machine.
std::string frames_text(const TrainSources& sources, const TrainInputs& inputs) {
  Json json{{"data", for_tasks(sources.data)},
            {"recipes", Json::array()},
            {"body", sources.body.empty() ? "" : read_file(sources.body)},
            {"count", sources.count},
            {"seed", sources.render_seed},
            {"motions", for_tasks(sources.assets.motions)},
            {"assets", assets_for_tasks(sources.assets.folder)},
            {"inputs", Json::array()}};
  for (const std::string& recipe : sources.recipes) {
    json["recipes"].push_back({{"name", recipe}, {"text", read_file(recipe)}});
  }
  for (const TrainInput& input : inputs.inputs()) {
    json["inputs"].push_back({{"name", input.name}, {"hash", hash_text(input)}, {"frames", input.frames}});
  }
  return json.dump();
}

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
    TrainingSet background(inputs_.body(), training_convention(options_), options_.sample,
                           static_cast<std::uint64_t>(options_.grow.seed));
    const std::vector<BackgroundFacts> facts =
        inputs_.read_backgrounds([&](const LabelledFrame& frame) { background.add(frame); });
    Forest forest = background.untrained_forest();
    forest.recipe = train_recipe(options_, inputs_, facts);
    session_.emplace(run_.out + ".work", forest, run_.restart);
    if (run_.restart) ClusterExecutor::clear(*engine);
    try {
      train(*engine, choice, background, std::move(forest));
    } catch (const Interrupted&) {
      throw Error(
          fmt::format("interrupted, finished jobs are in {}: the same command goes on", engine->store().place()));
    }
  }

 private:
  void train(Engine& engine, const EngineChoice& choice, const TrainingSet& background, Forest forest) {
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
    forest = train_forest(executor, std::move(forest), options_, *session_, observer);
    save_model(forest, run_.out);
    ClusterExecutor::clear(engine);
    session_->remove();
    if (!run_.shown) return;
    say(fmt::format("{}: {}, {:.2f} MiB, trained in {:.1f} s", run_.out, counted(std::ssize(forest.trees), "tree"),
                    double(fs::file_size(run_.out)) / kMiB,
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
    say(fmt::format("{} in {}, {:.2f} million samples, {:.2f} GiB", counted(total.frames, "frame"),
                    counted(executor.shards(), "shard"), double(samples) * 1e-6, double(total.bytes) / kGiB));
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

TaskContext::ReadFrame open_frames(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error("the sources of frames: damaged");
  const TemporaryFolder texts;
  const auto inputs = std::make_shared<const TrainInputs>(sources_of(json, texts));
  const Json& expected = json.at("inputs");
  for (std::size_t i = 0; i < inputs->inputs().size(); ++i) {
    const TrainInput& input = inputs->inputs()[i];
    const auto hash = expected.at(i).at("hash").get<std::string>();
    if (hash_text(input) == hash && input.frames >= expected.at(i).at("frames").get<int>()) continue;
    throw Error(
        fmt::format("{}: would give other frames here (hash {}) than where training was begun ({}); expected "
                    "the same files and packages of `vesalius assets` on all machines",
                    expected.at(i).at("name").get<std::string>(), hash_text(input), hash));
  }
  return [inputs](std::uint64_t number) {
    std::uint64_t left = number;
    for (const TrainInput& input : inputs->inputs()) {
      if (left < static_cast<std::uint64_t>(input.frames)) {
        return with_context(fmt::format("{}: frame {}", input.name, left), [&] { return input.frame(int(left)); });
      }
      left -= static_cast<std::uint64_t>(input.frames);
    }
    throw Error(fmt::format("frame {}: beyond the last one", number));
  };
}

}  // namespace vesalius::cli
