#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "cluster/engine.h"
#include "cluster/map_task.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

/// The flags of commands whose work machines can share.
struct ClusterFlags {
  std::string on;     ///< local:N, slurm, hadoop or script:FILE; empty for this process
  std::string store;  ///< place of the store; empty for the command's default
  int map_tasks = 0, reduce_tasks = 0, task_threads = 0;  ///< 0 takes the engine's default
  bool no_combiner = false;
  std::string program;    ///< path of vesalius on all machines; empty for this one's
  std::string arguments;  ///< more for sbatch, for Hadoop's streaming or for the script, separated by spaces
};

void add_cluster_flags(CLI::App& command, ClusterFlags& flags);

/// What --on names, and the flags with the engine's defaults.
struct EngineChoice {
  std::string kind;    ///< "local", "slurm", "hadoop", "script"
  int processes = 0;   ///< processes of local:N
  std::string script;  ///< path of script:FILE
  EngineOptions options;
};

/// Throws UsageError for an engine or a script that does not exist and for flags out of range.
EngineChoice choose_engine(const ClusterFlags& flags);

/// Makes the engine with its store: where --store says, or else in `default_folder`. Throws UsageError if the engine
/// cannot use the store.
std::unique_ptr<Engine> make_engine(const ClusterFlags& flags, const EngineChoice& choice,
                                    const std::string& default_folder);

/// Shows the progress of jobs: a line that changes on a terminal, a line for each job elsewhere.
std::function<void(const JobProgress&)> show_jobs(bool shown);

/// Returns paths as tasks need them, which run in other folders: absolute; an empty one stays empty.
std::string for_tasks(const std::string& path);
std::vector<std::string> for_tasks(std::vector<std::string> paths);
/// The same for the folder of `vesalius assets`; an empty one is this machine's default, since tasks may have another
/// home folder, or none.
std::string assets_for_tasks(const std::string& folder);

/// The flags of a task.
struct TaskArguments {
  std::string store, job;
  int threads = 0;
};
void add_task_flags(CLI::App& command, TaskArguments& arguments);

/// Runs a task on standard input and output. Counters go to standard error, as Hadoop's streaming reads them; what a
/// task of Hadoop fails of goes to the store as well, since Hadoop keeps it from the one who asked for the job.
void run_task(const TaskArguments& arguments,
              const std::function<TaskContext::ReadFrame(const std::string& source)>& open_source,
              const std::function<void(const TaskContext&, std::istream&, std::ostream&)>& task);

}  // namespace vesalius::cli
