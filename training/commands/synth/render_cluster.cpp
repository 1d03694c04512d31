#include "commands/synth/render_cluster.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "cluster/message.h"
#include "cluster/train_job.h"
#include "commands/cluster/cluster_flags.h"
#include "commands/synth/synth_recipe.h"
#include "console/interrupts.h"
#include "console/text_sink.h"
#include "dataset/labelled_dataset.h"
#include "dataset/labelled_frame_codec.h"
#include "io/files/atomic_file.h"
#include "io/files/options_file.h"
#include "io/files/plain_text.h"
#include "train/messages/training_protocol.h"
#include "train/parallel_in_order.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kJob = "render";

std::string stored_shard(std::uint64_t shard) { return fmt::format("shards/{:06}.shard", shard); }

std::string serialise(RenderRequest request, const DatasetInfo& info) {
  Json json{{"build", program_build()},
            {"recipe", options_toml([&](OptionVisitor& visitor) { visit_options("", request.recipe, visitor); })},
            {"body", request.body.toml},
            {"assets", assets_for_tasks(request.places.folder)},
            {"motions", for_tasks(request.places.motions)},
            {"clip_s", nullptr},
            {"rate_hz", nullptr},
            {"dataset", serialise_description(info)}};
  if (request.clip.clip_s) json["clip_s"] = *request.clip.clip_s;
  if (request.clip.rate_hz) json["rate_hz"] = *request.clip.rate_hz;
  return sealed(json.dump());
}

/// A job as a task reads it.
struct RenderJob {
  FrameMaker maker;
  DatasetInfo info;
  int part_count = 0;
};

RenderJob open_job(const std::string& bytes, const std::string& name) {
  const Json json = Json::parse(opened(bytes, name), nullptr, false);
  if (json.is_discarded()) throw Error(name + ": damaged");
  expect_this_build(json.at("build").get<std::string>(), name);
  RenderJob job;
  job.info = parse_description(json.at("dataset").get<std::string>(), name);
  synth::Recipe recipe;
  parse_options(json.at("recipe").get<std::string>(), name,
                [&](OptionVisitor& visitor) { visit_options("", recipe, visitor); });
  const BodyModel body = parse_body_model(json.at("body").get<std::string>(), name);
  ClipRequest clip;
  if (!json.at("clip_s").is_null()) clip.clip_s = json.at("clip_s").get<float>();
  if (!json.at("rate_hz").is_null()) clip.rate_hz = json.at("rate_hz").get<double>();
  LoadedAssets loaded = load_assets(recipe, {.folder = json.at("assets").get<std::string>(),
                                             .motions = json.at("motions").get<std::string>(),
                                             .movements = clip.clip_s.has_value()});
  if (full_recipe(recipe, loaded) != job.info.recipe) {
    throw Error(
        "frames would be others here than where rendering was begun; expected the same files and packages of "
        "`vesalius assets` on all machines");
  }
  job.maker = make_frame_maker(recipe, std::move(loaded.assets), body, job.info.seed, clip);
  job.part_count = body.part_count();
  return job;
}

void run_render_task(const TaskContext& context, std::istream& in, std::ostream& out) {
  const std::string file = job_file(context.job);
  const RenderJob job = open_job(context.store.read(file), context.store.place() + "/" + file);
  for (std::string line; std::getline(in, line);) {
    if (line.empty()) continue;
    const std::size_t shard = key_numbers(line.substr(line.rfind('\t') + 1), 1, "standard input")[0];
    const FrameRange range = frames_of_shard(job.info, shard);
    std::vector<std::string> frames;
    parallel_in_order(
        int(range.count),
        [&](int i) {
          const std::uint64_t index = range.first + static_cast<std::uint64_t>(i);
          return encode_frame({index, job.info.seed, job.maker.frame(index)}, job.part_count);
        },
        [&](int /*i*/, std::string bytes) {
          frames.push_back(std::move(bytes));
          context.count("frames", 1);
          return true;
        });
    context.store.write(stored_shard(shard), serialise_shard(dataset_hash(job.info), range.first, frames));
    out << record_line({shard_key(shard), std::to_string(range.count)});
  }
  out.flush();
}

}  // namespace

void render_on_cluster(const RenderRequest& request, const DatasetInfo& info, const std::string& folder,
                       const ClusterFlags& flags, bool shown) {
  EngineChoice choice = choose_engine(flags);
  choice.options.tell = show_jobs(shown);
  choice.options.stopped = interrupted;
  const std::unique_ptr<Engine> engine = make_engine(flags, choice, folder + ".work");
  const DatasetWriter writer(folder, info);  // holds the folder, and knows what is missing
  EngineJob job{kJob, "synth", {}, false};
  for (const FrameRange& range : writer.missing())
    job.lines.push_back(std::to_string(range.first / info.frames_per_shard));
  Store& store = engine->store();
  if (!job.lines.empty()) {
    const std::string bytes = serialise(request, info);
    if (!store.exists(job_file(kJob)) || store.read(job_file(kJob)) != bytes) {
      engine->remove(kJob);
      store.remove("shards");
      store.write(job_file(kJob), bytes);
    }
    try {
      engine->run(job);
    } catch (const Interrupted&) {
      throw Error(fmt::format("interrupted, finished shards are in {}: the same command goes on", store.place()));
    }
    for (const FrameRange& range : writer.missing()) {
      const std::uint64_t shard = range.first / info.frames_per_shard;
      write_file_atomically(shard_path(folder, shard), store.read(stored_shard(shard)));
    }
  }
  store.remove("shards");
  store.remove(job_folder(kJob));
  std::error_code ignored;  // it may have been the user's
  for (const char* own : {"/jobs", ""}) fs::remove(folder + ".work" + own, ignored);
  if (shown) say(folder + ": " + counted(DatasetReader(folder).size(), "frame"));
}

void add_render_task(CLI::App& synth) {
  synth.require_subcommand(0, 1);
  const auto arguments = std::make_shared<TaskArguments>();
  CLI::App* map = synth.add_subcommand("map", "Map task of a job: lines that name shards in, records out");
  add_task_flags(*map, *arguments);
  map->callback([arguments] { run_task(*arguments, {}, run_render_task); });
}

}  // namespace vesalius::cli
