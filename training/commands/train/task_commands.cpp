#include "commands/train/task_commands.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <string>

#include "cluster/map_task.h"
#include "cluster/reduce_task.h"
#include "commands/cluster/cluster_flags.h"
#include "commands/train/train_frames.h"
#include "vesalius/base/keep_memory.h"

namespace vesalius::cli {
namespace {

struct CombineArguments {
  std::string into;
  int parts = 1;
  bool unmerged = false;
};

}  // namespace

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

}  // namespace vesalius::cli
