#include "cli/train/task_commands.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include "cli/option_flags.h"
#include "cli/train/train_frames.h"
#include "cluster/map_task.h"
#include "cluster/reduce_task.h"
#include "cluster/train_job.h"
#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"

namespace vesalius::cli {
namespace {

struct TaskArguments {
  std::string store, job, into;
  int threads = 0, parts = 1;
  bool unmerged = false;
};

/// Writes counters as Hadoop's streaming reads them, at most every second.
class CounterLines {
 public:
  ~CounterLines() { flush(); }
  void add(const std::string& counter, std::uint64_t more) {
    counts_[counter] += more;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::seconds(1)) return;
    last_ = now;
    flush();
  }

 private:
  void flush() {
    for (const auto& [name, count] : counts_)
      std::fprintf(stderr, "reporter:counter:vesalius,%s,%llu\n", name.c_str(), static_cast<unsigned long long>(count));
    counts_.clear();
  }

  std::map<std::string, std::uint64_t> counts_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Hadoop keeps what a failed task says from the one who asked for the job, so the store takes it there.
void keep_for_driver(Store& store, const std::string& job, const std::string& message) {
  const char* attempt = std::getenv("mapreduce_task_attempt_id");
  if (attempt == nullptr) return;
  try {
    store.write(job_folder(job) + "/failed/" + attempt, message);
  } catch (const Error&) {  // the task fails in any case
  }
}

/// Runs a task on standard input and output.
template <class Task>
void run_task(const TaskArguments& arguments, const Task& task) {
  std::ios::sync_with_stdio(false);
  const ThreadLimit limit(arguments.threads);
  const std::unique_ptr<Store> store = open_store(arguments.store);
  CounterLines counters;
  const TaskContext context{
      .store = *store,
      .job = arguments.job,
      .open_source = open_frames,
      .count = [&](const std::string& counter, std::uint64_t more) { counters.add(counter, more); }};
  try {
    task(context, std::cin, std::cout);
  } catch (const Error& e) {
    keep_for_driver(*store, arguments.job, e.what());
    throw;
  }
}

void add_job_flags(CLI::App& command, TaskArguments& arguments) {
  command.add_option("--store", arguments.store, "Folder that all machines see, or webhdfs://HOST:PORT/PATH")
      ->type_name("PLACE")
      ->required();
  command.add_option("--job", arguments.job, "Name of the job in the store")->type_name("NAME")->required();
  command.add_option("--threads", arguments.threads, "Threads to use; 0 = all")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxThreads));
}

}  // namespace

void add_train_tasks(CLI::App& train) {
  train.require_subcommand(0, 1);
  const auto arguments = std::make_shared<TaskArguments>();
  CLI::App* map = train.add_subcommand("map", "Map task of a job: lines that name shards in, records out");
  add_job_flags(*map, *arguments);
  map->callback([arguments] { run_task(*arguments, run_map_task); });
  CLI::App* combine = train.add_subcommand("combine", "Merges neighbouring records of one key");
  combine->add_option("--into", arguments->into, "Write PREFIX.0, PREFIX.1 ... instead of standard output")
      ->type_name("PREFIX");
  combine->add_option("--parts", arguments->parts, "Files to divide the keys among")->check(CLI::Range(1, 100000));
  combine->add_flag("--unmerged", arguments->unmerged, "With --into: divide only");
  combine->callback([arguments] {
    std::ios::sync_with_stdio(false);
    if (arguments->into.empty()) return run_combine_task(std::cin, std::cout);
    run_partition_task(std::cin, arguments->into, arguments->parts, !arguments->unmerged);
  });
  CLI::App* reduce = train.add_subcommand("reduce", "Reduce task of a job: records in, results out");
  add_job_flags(*reduce, *arguments);
  reduce->callback([arguments] { run_task(*arguments, run_reduce_task); });
}

}  // namespace vesalius::cli
