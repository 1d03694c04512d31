#include "commands/cluster/cluster_task.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>

#include "cluster/train_job.h"
#include "console/option_flags.h"
#include "downloads/assets.h"
#include "vesalius/base/keep_memory.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

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

}  // namespace

std::string for_tasks(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).lexically_normal().string();
}

std::vector<std::string> for_tasks(std::vector<std::string> paths) {
  for (std::string& path : paths) path = for_tasks(path);
  return paths;
}

std::string assets_for_tasks(const std::string& folder) {
  return for_tasks(folder.empty() ? default_assets_folder() : folder);
}

void add_task_flags(CLI::App& command, TaskArguments& arguments) {
  command.add_option("--store", arguments.store, "Folder that all machines see, or webhdfs://HOST:PORT/PATH")
      ->type_name("PLACE")
      ->required();
  command.add_option("--job", arguments.job, "Name of the job in the store")->type_name("NAME")->required();
  command.add_option("--threads", arguments.threads, "Threads to use; 0 = all")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxThreads));
}

void run_task(const TaskArguments& arguments,
              const std::function<TaskContext::ReadFrame(const std::string& source)>& open_source,
              const std::function<void(const TaskContext&, std::istream&, std::ostream&)>& task) {
  std::ios::sync_with_stdio(false);
  keep_freed_memory();
  const ThreadLimit limit(arguments.threads);
  const std::unique_ptr<Store> store = open_store(arguments.store);
  CounterLines counters;
  const TaskContext context{
      .store = *store,
      .job = arguments.job,
      .open_source = open_source,
      .count = [&](const std::string& counter, std::uint64_t more) { counters.add(counter, more); }};
  try {
    task(context, std::cin, std::cout);
  } catch (const Error& e) {
    keep_for_driver(*store, arguments.job, e.what());
    throw;
  }
}

}  // namespace vesalius::cli
