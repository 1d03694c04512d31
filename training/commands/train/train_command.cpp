
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "cluster/map_task.h"
#include "cluster/reduce_task.h"
#include "commands/cluster/cluster_flags.h"
#include "commands/train/make_model.h"
#include "commands/train/model_recipe.h"
#include "commands/train/train_cluster.h"
#include "commands/train/train_inputs.h"
#include "commands/train/train_plan.h"
#include "commands/train/train_run.h"
#include "commands/training_commands.h"
#include "console/interrupts.h"
#include "console/option_flags.h"
#include "console/satellites.h"
#include "console/source_flags.h"
#include "console/text_sink.h"
#include "io/files/atomic_file.h"
#include "io/files/options_file.h"
#include "vesalius/base/keep_memory.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {

namespace {

constexpr int kMaxFrames = 100'000'000;
constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;

struct Arguments {
  explicit Arguments(CLI::App& command) : train_flags(command) {}

  TrainSources sources;
  std::string out, options_file, report, device = "cpu";
  OptionFlags<TrainOptions> train_flags;
  double memory_gib = 0.0, scale = 1.0;
  int threads = 0;
  TrainClusterFlags cluster;
  bool estimate = false, restart = false, curves = false, quiet = false;
};

TrainOptions make_options(const Arguments& arguments) {
  TrainOptions options;
  if (!arguments.options_file.empty()) {
    read_options(arguments.options_file, [&](OptionVisitor& visitor) { visit_options("", options, visitor); });
  }
  arguments.train_flags.apply(options);
  check(options);
  return options;
}

void check(const Arguments& arguments, const TrainOptions& options) {
  if (arguments.out.empty() && !arguments.estimate)
    throw UsageError("expected --out, the model to write, or --estimate");
  std::error_code ignored;
  if (written_directly(arguments.out) || std::filesystem::is_directory(arguments.out, ignored)) {
    throw UsageError(arguments.out + ": expected the name of a file to write");
  }
  if (!arguments.cluster.engine.on.empty() && (!arguments.report.empty() || arguments.estimate)) {
    throw UsageError("--on expects neither --report nor --estimate, which need all frames in one process");
  }
  if (!arguments.cluster.engine.on.empty() && arguments.device != "cpu") {
    throw UsageError("--on expects no --device: the tasks of an engine run on processors");
  }
  if (arguments.curves && arguments.report.empty()) throw UsageError("--curves expects --report, where they go");
  if (!arguments.report.empty() && options.sample.held_out_share <= 0.F) {
    throw UsageError("--report expects frames to measure accuracy on: held-out-share above 0");
  }
  if (!arguments.sources.backgrounds.empty() && options.sample.background_share <= 0.F) {
    throw UsageError("--background expects a background class: background-share above 0");
  }
}

std::uint64_t memory_limit(const Arguments& arguments) {
  return arguments.memory_gib > 0.0 ? static_cast<std::uint64_t>(arguments.memory_gib * kGiB) : default_memory();
}

TrainRun run_of(const Arguments& arguments) {
  return {.out = arguments.out,
          .report = arguments.report,
          .curves = arguments.curves,
          .restart = arguments.restart,
          .shown = !arguments.quiet,
          .device = arguments.device,
          .max_bytes = memory_limit(arguments)};
}

/// Returns whether the recipe is one of a whole model. Recipes of synth come with a number of frames.
bool makes_model(const Arguments& arguments) {
  return arguments.sources.recipes.size() == 1 && arguments.sources.count == 0;
}

void expect_network_flags(const Arguments& arguments) {
  const bool for_forests =
      !arguments.report.empty() || !arguments.sources.backgrounds.empty() || !arguments.cluster.engine.on.empty();
  if (for_forests) throw UsageError("the recipe is a network's: expected neither --report, --background nor --on");
}

void make_model(const Arguments& arguments) {
  if (!arguments.sources.data.empty() || !arguments.options_file.empty() || !arguments.sources.body.empty()) {
    throw UsageError("the recipe of a model says what --data, --options and --body say otherwise");
  }
  ModelRecipe recipe = read_model_recipe(arguments.sources.recipes.front());
  arguments.train_flags.apply(recipe.forest);
  check(arguments, recipe.forest);
  if (recipe.network) expect_network_flags(arguments);
  recipe.backgrounds.insert(recipe.backgrounds.end(), arguments.sources.backgrounds.begin(),
                            arguments.sources.backgrounds.end());
  scale(recipe, arguments.scale);
  ModelMaker maker(
      {run_of(arguments), arguments.sources.assets, arguments.sources.camera, arguments.cluster, arguments.scale < 1.0},
      std::move(recipe));
  if (arguments.estimate) return print(maker.estimate());
  watch_interrupts();
  maker.make();
}

void run(const Arguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  if (makes_model(arguments)) return make_model(arguments);
  if (arguments.scale != 1.0) throw UsageError("--scale expects --recipe, the recipe of a model");
  const TrainOptions options = make_options(arguments);
  check(arguments, options);
  if (!arguments.cluster.engine.on.empty()) {
    watch_interrupts();
    return train_on_cluster(run_of(arguments), options, arguments.sources, arguments.cluster);
  }
  const TrainInputs inputs(arguments.sources);
  if (!arguments.quiet) {
    for (const std::string& note : inputs.notes()) say("note: " + note);
  }
  const auto plan = [&] { return plan_training(inputs, options, arguments.curves, memory_limit(arguments)); };
  if (arguments.estimate) return print(plan().text());
  watch_interrupts();
  train(run_of(arguments), options, inputs, plan);
}

void add_source_flags(CLI::App& command, TrainSources& sources) {
  const std::string group = "What to learn from";
  const auto add = [&](const char* name, auto& value, const char* help, const char* type) {
    return command.add_option(name, value, help)->type_name(type)->group(group);
  };
  add("--data", sources.data, "Folders that `vesalius synth` wrote", "DIR");
  add("--recipe", sources.recipes,
      "Recipe of a whole model: frames, forest, context and judge (docs/retrain.md). With --count, recipes of synth, "
      "whose frames are rendered and not kept",
      "FILE");
  add("--count", sources.count, "Frames to render of each recipe of synth; most frames to take of each dataset", "N")
      ->check(CLI::Range(1, kMaxFrames));
  add("--recipe-seed", sources.render_seed, "Seed of the rendered frames, as in `vesalius synth --seed`", "N")
      ->capture_default_str();
  add("--background", sources.backgrounds, "Frames of rooms without people: all that `vesalius detect` reads",
      "SOURCE");
  add("--body", sources.body, "Body model with other parts, for --recipe", "FILE");
  add("--motions", sources.assets.motions, "Motions of your own for --recipe: a folder of .bvh, or .amc with .asf",
      "DIR");
  add("--assets", sources.assets.folder, "Folder in which `vesalius assets` put its files", "DIR");
  add_camera_flags(command, sources.camera);
}

void add_run_flags(CLI::App& command, Arguments& arguments) {
  const std::string group = "Run";
  command
      .add_option("--scale", arguments.scale, "A trial of a model's recipe: so large a share of the frames of each set")
      ->type_name("SHARE")
      ->check(CLI::Range(1e-6, 1.0))
      ->group(group);
  command.add_flag("--estimate", arguments.estimate, "Only estimate time and memory")->group(group);
  command.add_option("--memory", arguments.memory_gib, "GiB it may take (default: 80 % of what the machine has)")
      ->type_name("GIB")
      ->check(CLI::Range(0.01, 1e6))
      ->group(group);
  command.add_flag("--restart", arguments.restart, "Discard what an interrupted run has done")->group(group);
  command.add_option("--report", arguments.report, "Folder for a report, a web page")->type_name("DIR")->group(group);
  command.add_flag("--curves", arguments.curves, "With --report: accuracy against frames and candidates as well")
      ->group(group);
  command.add_option("--threads", arguments.threads, "Threads to use; 0 = all. The result is the same")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxThreads))
      ->group(group);
  command
      .add_option("--device", arguments.device,
                  device_help("What trains", "cuda or cuda:N (a card), cuda:N,cuda:M (several)"))
      ->type_name("NAME")
      ->capture_default_str()
      ->group(group);
  command.add_flag("-q,--quiet", arguments.quiet, "Print errors only")->group(group);
}

struct CombineArguments {
  std::string into;
  int parts = 1;
  bool unmerged = false;
};

/// Adds `map`, `combine` and `reduce`: the tasks that engines run.
void add_train_tasks(CLI::App& train) {
  train.require_subcommand(0, 1);
  const auto arguments = std::make_shared<TaskArguments>();
  CLI::App* map = train.add_subcommand("map", "Map task of a job: lines that name shards in, records out");
  add_task_flags(*map, *arguments);
  map->callback([arguments] { run_task(*arguments, open_frames, run_map_task); });
  const auto combining = std::make_shared<CombineArguments>();
  CLI::App* combine = train.add_subcommand("combine", "Merges neighbouring records of one key");
  combine->add_option("--into", combining->into, "Write PREFIX.0, PREFIX.1 ... instead of standard output")
      ->type_name("PREFIX");
  combine->add_option("--parts", combining->parts, "Files to divide the keys among")
      ->type_name("N")
      ->check(CLI::Range(1, 100000));
  combine->add_flag("--unmerged", combining->unmerged, "With --into: divide only");
  combine->callback([combining] {
    std::ios::sync_with_stdio(false);
    keep_freed_memory();
    if (combining->into.empty()) return run_combine_task(std::cin, std::cout);
    run_partition_task(std::cin, combining->into, combining->parts, !combining->unmerged);
  });
  CLI::App* reduce = train.add_subcommand("reduce", "Reduce task of a job: records in, results out");
  add_task_flags(*reduce, *arguments);
  reduce->callback([arguments] { run_task(*arguments, {}, run_reduce_task); });
}

}  // namespace

void add_train(CLI::App& program) {
  CLI::App* command = program.add_subcommand("train", "Make a model: frames, forest, context, judge");
  const auto arguments = std::make_shared<Arguments>(*command);
  add_source_flags(*command, arguments->sources);
  const std::string group = "Forest";
  command->add_option("--out", arguments->out, "Model to write; OUT.work keeps what is done until then")
      ->type_name("FILE")
      ->group(group);
  command->add_option("--options", arguments->options_file, "TOML file of options; `vesalius options train` prints one")
      ->type_name("FILE")
      ->group(group);
  for (const char* name : {"--trees", "--depth", "--candidates", "--pixels"}) {
    command->get_option(name)->type_name("N")->group(group);
  }
  add_run_flags(*command, *arguments);
  add_cluster_flags(*command, arguments->cluster.engine);
  const std::string machines = "Several machines (docs/cluster.md)";
  command->add_option("--shard-frames", arguments->cluster.shard_frames, "Frames of a shard")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str()
      ->group(machines);
  command
      ->add_option("--task-memory", arguments->cluster.task_memory_gib,
                   "GiB of a map task for all frames: where they fit, it grows whole subtrees")
      ->type_name("GIB")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str()
      ->group(machines);
  add_train_tasks(*command);
  command->footer(R"(
A model's recipe is made step by step; OUT.work keeps the frames and what else is done, also afterwards, so that a
changed recipe makes again only what depends on the change. It may be removed.

The options that decide how a forest is trained are flags too, e.g. --min-samples 20; `vesalius options train` lists
them. An interrupted run continues when the same command is given again, and ends with the same model.

Examples:
  vesalius train --recipe data/models/quick.toml --out quick.forest
  vesalius train --recipe data/models/default.toml --scale 0.001 --out trial.forest
  vesalius train --data train/ --out my.forest --report report/
  vesalius train --data kinect/ d435/ --background office/ --trees 4 --estimate
  vesalius train --recipe ceiling.toml --count 20000 --out ceiling.forest)");
  command->callback([arguments, command] {
    if (command->get_subcommands().empty()) run(*arguments);
  });
}

Satellite train_satellite() {
  return {.name = "train", .commands = {add_train}, .default_options = [] {
            TrainOptions options;
            return options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
          }};
}

}  // namespace vesalius::cli
