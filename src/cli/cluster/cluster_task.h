#pragma once

#include <functional>
#include <iosfwd>
#include <string>

#include "cluster/map_task.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

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
