#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "cluster/map_task.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

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
