#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>

#include "cluster/folder_engine.h"
#include "cluster/process.h"
#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPause{150};
constexpr int kAskEvery = 4;                   ///< pauses from one question to Slurm to the next
constexpr std::chrono::seconds kPatience{60};  ///< with a queue that starts nothing, before the user is told
constexpr int kMostSilence = 20;               ///< questions in a row that Slurm may leave without an answer
constexpr int kCutOff = 7;                     ///< a question that took too long counts as so many

/// Returns the task numbers as Slurm takes them, e.g. 0-6,9.
std::string array_of(const std::vector<int>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[i]);
    if (last > i) text += fmt::format("-{}", numbers[last]);
    i = last + 1;
  }
  return text;
}

class SlurmEngine : public FolderEngine {
 public:
  using FolderEngine::FolderEngine;

 protected:
  void run_tasks(const Tasks& tasks) override {
    const std::string id_file = id_file_of(tasks.folder, tasks.kind);
    const std::string id = submit(tasks);
    write_file_atomically(id_file, id);
    try {
      wait_for(tasks, id);
    } catch (...) {
      ask({"scancel", id});
      throw;
    }
    std::filesystem::remove(id_file);
  }

  void end_tasks(const std::string& folder) override {
    for (const char* kind : {"map", "reduce"}) {
      const std::string id_file = id_file_of(folder, kind);
      std::error_code ignored;
      if (!std::filesystem::exists(id_file, ignored)) continue;
      const CommandResult result = ask({"scancel", read_file(id_file)});
      if (!result.in_time) throw Error("Slurm: " + result.err);
      std::filesystem::remove(id_file);
    }
  }

 private:
  /// Where the number of Slurm's job is kept while it may run.
  static std::string id_file_of(const std::string& folder, const std::string& kind) {
    return fmt::format("{}/{}.slurm", folder, kind);
  }

  CommandResult ask(const std::vector<std::string>& command) const {
    return run_command(command, std::chrono::duration<double>(options().answer_s));
  }

  std::string submit(const Tasks& tasks) const {
    std::vector<std::string> command{"sbatch",
                                     "--parsable",
                                     "--requeue",
                                     "--export=ALL",
                                     "--job-name=vesalius-" + tasks.job + "-" + tasks.kind,
                                     "--array=" + array_of(tasks.numbers),
                                     fmt::format("--cpus-per-task={}", options().task_threads),
                                     fmt::format("--output={}/{}-%a.slurm.log", tasks.folder, tasks.kind)};
    command.insert(command.end(), options().arguments.begin(), options().arguments.end());
    command.insert(command.end(), {tasks.folder + "/task.sh", tasks.kind});
    const CommandResult result = ask(command);
    if (!result.in_time) throw Error("Slurm: " + result.err);
    const std::string id = result.out.substr(0, result.out.find_first_of(";\n"));
    if (result.exit_code != 0 || id.empty()) throw Error("Slurm refuses the job: " + last_words(result.err));
    return id;
  }

  /// Waits until no task is in the queue any more.
  void wait_for(const Tasks& tasks, const std::string& id) const {
    const Clock::time_point start = Clock::now();
    bool started = false;
    int silent = 0;
    std::string waiting;
    for (int pause = 0;; ++pause) {
      report(tasks, waiting);
      if (std::ranges::all_of(tasks.numbers, [&](int number) { return done(tasks, number); })) return;
      if (pause % kAskEvery == 0) {
        const CommandResult queue = ask({"squeue", "-h", "-r", "-t", "all", "-j", id, "-o", "%T %r"});
        silent = queue.exit_code == 0 ? 0 : silent + (queue.in_time ? 1 : kCutOff);
        if (queue.exit_code != 0 && queue.err.find("Invalid job id") != std::string::npos) return;
        if (silent > kMostSilence) {
          throw Error((queue.in_time ? "Slurm does not answer any more: " : "Slurm: ") + last_words(queue.err));
        }
        if (silent == 0 && !is_alive(queue.out)) return;
        started = started || queue.out.find("RUNNING") != std::string::npos;
        waiting = !started && Clock::now() - start > kPatience ? reason_of(queue.out) : "";
      }
      std::this_thread::sleep_for(kPause);
    }
  }

  /// Returns whether any task will run or is running.
  static bool is_alive(const std::string& states) {
    return std::ranges::any_of(std::vector<const char*>{"PENDING", "RUNNING", "REQUEUE", "COMPLETING", "CONFIGURING",
                                                        "SUSPENDED", "STOPPED", "RESIZING", "SIGNALING"},
                               [&](const char* state) { return states.find(state) != std::string::npos; });
  }

  /// Returns why the first task of a list of states and reasons is not running.
  static std::string reason_of(const std::string& states) {
    const std::size_t space = states.find(' ');
    if (space == std::string::npos) return "";
    return fmt::format(", waiting for Slurm: {}", states.substr(space + 1, states.find('\n') - space - 1));
  }
};

}  // namespace

std::unique_ptr<Engine> make_slurm_engine(std::unique_ptr<Store> store, const EngineOptions& options) {
  return std::make_unique<SlurmEngine>(std::move(store), options);
}

}  // namespace vesalius
