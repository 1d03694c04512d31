#pragma once

// Who runs the tasks of a job. An engine knows nothing of training: it passes lines to `vesalius train map`, sorts what
// comes out, passes it on to `vesalius train reduce`, and runs again what fails.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cluster/store.h"

namespace vesalius {

/// A job whose file is in the store.
struct EngineJob {
  std::string name;
  std::string command = "train";   ///< the tasks are `vesalius COMMAND map` and `reduce`
  std::vector<std::string> lines;  ///< input of the map tasks; those that take longest first
  bool reduced = false;            ///< whether there are reduce tasks
  bool summed = false;             ///< whether its records add up, so that combiners make them fewer
};

struct JobProgress {
  std::string job, phase;  ///< phase: "map", "reduce"
  int done = 0, tasks = 0;
  std::map<std::string, std::uint64_t> counters;  ///< what tasks have counted so far
};

struct EngineOptions {
  std::string program;  ///< path of vesalius on all machines
  int map_tasks = 1;    ///< most map tasks of a job
  int reduce_tasks = 1;
  int task_threads = 1;  ///< threads of a task
  bool combine = true;
  int attempts = 4;                    ///< attempts of a task, before the job fails
  double answer_s = 30.0;              ///< time within which the engine's commands must answer
  std::vector<std::string> arguments;  ///< more for sbatch, for Hadoop's streaming, or for the script
  std::function<void(const JobProgress&)> tell = [](const JobProgress& /*progress*/) {};
  std::function<bool()> stopped = [] { return false; };  ///< asked several times a second
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual Store& store() = 0;
  /// Runs a job to its end. Afterwards the files part-* in result_folder(job) hold its records. What an earlier,
  /// interrupted run of the same job finished may be used. Throws Error saying which task failed for good and with what
  /// last line, if the engine refuses, and Interrupted if asked to stop.
  virtual void run(const EngineJob& job) = 0;
  /// Ends what a killed driver left running or in a queue for a job. Throws Error where the engine does not answer.
  virtual void end_earlier(const std::string& /*job*/) {}
  /// Removes a job from the store, after what is left of it has ended. Throws Error as `end_earlier` does.
  void remove(const std::string& job);
};

std::string result_folder(const std::string& job);

/// Returns the input of each of at most `most` map tasks. The lines are dealt out, so that what takes longest is
/// spread. Throws Error if there are none.
std::vector<std::string> inputs_of(const EngineJob& job, int most);

/// Runs at most `processes` tasks at a time on this machine.
std::unique_ptr<Engine> make_local_engine(std::unique_ptr<Store> store, const EngineOptions& options, int processes);
/// Submits jobs to Hadoop's streaming; the store is in HDFS.
std::unique_ptr<Engine> make_hadoop_engine(std::unique_ptr<Store> store, const EngineOptions& options);
/// Submits tasks to Slurm as array jobs; the store is a folder that all nodes share.
std::unique_ptr<Engine> make_slurm_engine(std::unique_ptr<Store> store, const EngineOptions& options);
/// Runs a program of the user's for each job, which brings the tasks to an engine of its own (docs/cluster.md); the
/// store is a folder.
std::unique_ptr<Engine> make_script_engine(std::unique_ptr<Store> store, const EngineOptions& options,
                                           const std::string& script);

}  // namespace vesalius
