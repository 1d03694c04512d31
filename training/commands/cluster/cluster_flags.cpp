#include "commands/cluster/cluster_flags.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <utility>

#include "cluster/train_job.h"
#include "console/option_flags.h"
#include "console/satellites.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "downloads/assets.h"
#include "vesalius/base/keep_memory.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

constexpr int kMostTasks = 100'000;
constexpr int kDefaultMapTasks = 8;
constexpr int kMostReducers = 4;  ///< unless asked for more
constexpr const char* kLocal = "local:";
constexpr const char* kScript = "script:";

/// Returns the number of processes of local:N.
int local_processes(const std::string& on) {
  int processes = 0;
  const char* begin = on.data() + std::string(kLocal).size();
  const auto [end, error] = std::from_chars(begin, on.data() + on.size(), processes);
  if (error != std::errc{} || end != on.data() + on.size() || processes < 1 || processes > kMostTasks) {
    throw UsageError(fmt::format("--on {}: expected local:N with N from 1 to {}", on, kMostTasks));
  }
  return processes;
}

/// Returns the path of script:FILE.
std::string script_path(const std::string& on) {
  const std::string file = on.substr(std::string(kScript).size());
  std::error_code ignored;
  if (file.empty()) throw UsageError("--on script:: expected script:FILE, a program");
  if (!std::filesystem::exists(file, ignored)) throw UsageError(fmt::format("--on {}: no such file", on));
  if (!std::filesystem::is_regular_file(file, ignored) || ::access(file.c_str(), X_OK) != 0) {
    throw UsageError(fmt::format("--on {}: expected a program, the file cannot be executed", on));
  }
  return for_tasks(file);
}

std::string this_program() {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) throw UsageError("expected --program, the path of vesalius on all machines");
  return path.string();
}

std::string counters_of(const JobProgress& progress) {
  std::string text;
  for (const auto& [name, count] : progress.counters) {
    if (name != "shards") text += fmt::format(", {} {}", count, name);
  }
  return text;
}

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

/// Returns where PATH has a program, or that it has not.
std::string place_of(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::string file = fmt::format("{}/{}", folder, program);
    std::error_code ignored;
    if (!folder.empty() && std::filesystem::is_regular_file(file, ignored)) return file;
  }
  return "no " + program + " in PATH";
}

}  // namespace

void add_cluster_flags(CLI::App& command, ClusterFlags& flags) {
  const std::string group = "Several machines (docs/cluster.md)";
  const auto add = [&](const char* name, auto& value, const char* help, const char* type) {
    return command.add_option(name, value, help)->type_name(type)->group(group);
  };
  add("--on", flags.on,
      "Who does the work: local:N (so many processes), slurm, hadoop, or script:FILE (any other engine). The result is "
      "the same",
      "ENGINE");
  add("--store", flags.store,
      "Folder that all machines see, or webhdfs://HOST:PORT/PATH (default: beside --out; hadoop needs one)", "PLACE");
  add("--map-tasks", flags.map_tasks, "Map tasks of a job (default: N of local:N, else 8)", "N")
      ->check(CLI::Range(1, kMostTasks));
  add("--reduce-tasks", flags.reduce_tasks, "Reduce tasks of a job (default: as many, at most 4)", "N")
      ->check(CLI::Range(1, kMostTasks));
  add("--task-threads", flags.task_threads, "Threads of a task (default: 1; local:N shares out the processors)", "N")
      ->check(CLI::Range(1, kMaxThreads));
  command.add_flag("--no-combiner", flags.no_combiner, "Do not merge what a map task writes")->group(group);
  add("--program", flags.program, "Path of vesalius on all machines (default: this one's)", "FILE");
  add("--engine-arguments", flags.arguments, "More arguments for sbatch, for Hadoop's streaming, or for the script",
      "ARGS");
}

EngineChoice choose_engine(const ClusterFlags& flags) {
  EngineChoice choice;
  EngineOptions& options = choice.options;
  if (flags.on.starts_with(kLocal)) {
    choice.kind = "local";
    choice.processes = local_processes(flags.on);
    options.map_tasks = choice.processes;
    options.task_threads = std::max(1, thread_count() / choice.processes);
  } else if (flags.on == "slurm" || flags.on == "hadoop") {
    choice.kind = flags.on;
    options.map_tasks = kDefaultMapTasks;
  } else if (flags.on.starts_with(kScript)) {
    choice.kind = "script";
    choice.script = script_path(flags.on);
    options.map_tasks = kDefaultMapTasks;
  } else {
    throw UsageError(fmt::format("--on {}: expected local:N, slurm, hadoop or script:FILE", flags.on));
  }
  if (flags.map_tasks > 0) options.map_tasks = flags.map_tasks;
  options.reduce_tasks = flags.reduce_tasks > 0 ? flags.reduce_tasks : std::min(options.map_tasks, kMostReducers);
  if (flags.task_threads > 0) options.task_threads = flags.task_threads;
  options.combine = !flags.no_combiner;
  options.program = flags.program.empty() ? this_program() : flags.program;
  std::istringstream words(flags.arguments);
  for (std::string word; words >> word;) options.arguments.push_back(word);
  return choice;
}

std::unique_ptr<Engine> make_engine(const ClusterFlags& flags, const EngineChoice& choice,
                                    const std::string& default_folder) {
  const bool web = flags.store.starts_with("webhdfs://");
  if (choice.kind == "hadoop") {
    if (!web) throw UsageError("--on hadoop expects --store webhdfs://HOST:PORT/PATH, a folder of HDFS");
    return make_hadoop_engine(open_store(flags.store), choice.options);
  }
  if (web) throw UsageError(fmt::format("--on {} expects a folder as --store", flags.on));
  std::unique_ptr<Store> store = open_store(flags.store.empty() ? default_folder : flags.store);
  if (choice.kind == "script") return make_script_engine(std::move(store), choice.options, choice.script);
  if (choice.kind == "slurm") return make_slurm_engine(std::move(store), choice.options);
  return make_local_engine(std::move(store), choice.options, choice.processes);
}

std::function<void(const JobProgress&)> show_jobs(bool shown) {
  struct State {
    explicit State(bool show) : line(show) {}
    StatusLine line;
    std::string job;
    std::chrono::steady_clock::time_point start;
  };
  const auto state = std::make_shared<State>(shown);
  return [state](const JobProgress& progress) {
    const auto now = std::chrono::steady_clock::now();
    if (state->job != progress.job) {
      state->job = progress.job;
      state->start = now;
    }
    if (!state->line.due()) return;
    const double seconds = std::chrono::duration<double>(now - state->start).count();
    const double done = double(progress.done) / std::max(1, progress.tasks);
    std::string text = fmt::format("{}: {}, {} of {} tasks{}, {:.0f} s", progress.job, progress.phase, progress.done,
                                   progress.tasks, counters_of(progress), seconds);
    if (done > 0.0 && done < 1.0) text += fmt::format(", {:.0f} s left", seconds / done * (1.0 - done));
    state->line.show(text);
  };
}

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

Satellite cluster_satellite() {
  return {.name = "cluster", .commands = {}, .facts = [] {
            return std::vector<std::pair<std::string, std::string>>{{"Slurm", place_of("sbatch")},
                                                                    {"Hadoop", place_of("mapred")}};
          }};
}

}  // namespace vesalius::cli
