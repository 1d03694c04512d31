#include "cluster/folder_engine.h"

#include <fmt/format.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>

#include "cluster/process.h"
#include "cluster/train_job.h"
#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "train/messages/training_protocol.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCounter = "reporter:counter:vesalius,";  ///< as Hadoop's streaming expects

/// Calls `take` with each line of a text.
template <class Take>
void for_lines(const std::string& text, const Take& take) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    take(text.substr(begin, end - begin));
    begin = end + 1;
  }
}

std::string log_of(const std::string& folder, const std::string& kind, int number) {
  return fmt::format("{}/{}-{}.log", folder, kind, number);
}

std::string text_of(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) ? read_file(path) : std::string();
}

/// Sorting, merging and compressing belong to the shell's tools and to the task; the script holds them together.
/// It writes beside the names that others read, so that a task may run twice at the same time.
constexpr const char* kScript = R"(#!/usr/bin/env bash
# One task of a job: task.sh map|reduce NUMBER. A task that fails is tried again; one that is done is not run.
set -uo pipefail
cd {folder} || exit 1
export LC_ALL=C
tab=$'\t' kind=$1 number=${{2:-${{SLURM_ARRAY_TASK_ID:-}}}}
own=".$(uname -n).$$"
program={program}
task() {{ "$program" {command} "$1" --store {store} --job {job} --threads {threads}; }}
sorted() {{ sort -s -t "$tab" -k 1,1 -S 128M -T . "$@"; }}
map_only() {{ task map <"in-$number" >"out/.part-m-$number$own" && mv "out/.part-m-$number$own" "out/part-m-$number"; }}
map_for_reduce() {{ task map <"in-$number" | sorted | "$program" train combine {merge} --parts {reducers} --into "map-$number"; }}
reduce() {{
  local inputs
  inputs=$(printf "map-%d.$number " {maps})
  sorted -m $inputs | task reduce >"out/.part-r-$number$own" && mv "out/.part-r-$number$own" "out/part-r-$number"
}}
case $kind in
  map) run={map} ;;
  reduce) run=reduce ;;
esac
[ -e "$kind-$number.done" ] && exit 0
for _ in $(seq {attempts}); do
  if $run 2>"$kind-$number.log"; then
    rm -f "out/.part-"*"$own"
    touch "$kind-$number.done"
    exit 0
  fi
done
rm -f "out/.part-"*"$own"
exit 1
)";

constexpr std::chrono::milliseconds kPause{20};
constexpr int kReportEvery = 10;  ///< pauses

class LocalEngine : public FolderEngine {
 public:
  LocalEngine(std::unique_ptr<Store> store, const EngineOptions& options, int processes)
      : FolderEngine(std::move(store), options), processes_(processes) {}

 protected:
  void run_tasks(const Tasks& tasks) override {
    std::vector<ChildProcess> running;
    auto next = tasks.numbers.begin();
    for (int pause = 0; next != tasks.numbers.end() || !running.empty(); ++pause) {
      std::vector<ChildProcess> still;
      for (ChildProcess& child : running) {
        if (!child.ended()) still.push_back(std::move(child));
      }
      running.swap(still);
      for (; next != tasks.numbers.end() && std::ssize(running) < processes_; ++next) {
        running.emplace_back(
            std::vector<std::string>{"bash", tasks.folder + "/task.sh", tasks.kind, std::to_string(*next)},
            tasks.folder + "/" + tasks.kind + "-" + std::to_string(*next) + ".sh.log");
      }
      if (pause % kReportEvery == 0) report(tasks);
      std::this_thread::sleep_for(kPause);
    }
  }

 private:
  int processes_;
};

}  // namespace

std::string result_folder(const std::string& job) { return job_folder(job) + "/out"; }

void Engine::remove(const std::string& job) {
  end_earlier(job);
  store().remove(job_folder(job));
}

std::vector<std::string> inputs_of(const EngineJob& job, int most) {
  std::vector<std::string> inputs(std::min<std::size_t>(job.lines.size(), most));
  if (inputs.empty()) throw Error(job.name + ": a job without input");
  for (std::size_t i = 0; i < job.lines.size(); ++i) inputs[i % inputs.size()] += job.lines[i] + "\n";
  return inputs;
}

std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) c == '\'' ? word += "'\\''" : word += c;
  return word + "'";
}

std::string last_words(const std::string& log) {
  std::string last, ours;
  for_lines(log, [&](const std::string& line) {
    if (line.empty() || line.starts_with("reporter:")) return;
    last = line;
    if (line.starts_with("vesalius: ")) ours = line.substr(std::string("vesalius: ").size());
  });
  return !ours.empty() ? ours : !last.empty() ? last : "it said nothing";
}

FolderEngine::FolderEngine(std::unique_ptr<Store> store, EngineOptions options)
    : store_(std::move(store)), options_(std::move(options)) {}

void FolderEngine::run(const EngineJob& job) {
  const std::string folder = store_->place() + "/" + job_folder(job.name), results = folder + "/out";
  const std::vector<std::string> inputs = inputs_of(job, options_.map_tasks);
  const auto maps = int(inputs.size());
  std::string all;
  for (const std::string& input : inputs) all += input + "-\n";
  // Tasks of a killed driver that divided the work otherwise may still run: each division has a folder of its own.
  const std::string division = all + script(job, maps, "");
  const std::string own = fmt::format("{}/tasks-{:016x}", folder, XXH64(division.data(), division.size(), 0));
  std::error_code error;
  fs::create_directories(own + "/out", error);
  if (error) throw Error(own + "/out: folder cannot be made: " + error.message());
  end_earlier(job.name);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path() != own && entry.path().filename() != "job") fs::remove_all(entry.path(), error);
  }
  for (int i = 0; i < maps; ++i) write_file_atomically(fmt::format("{}/in-{}", own, i), inputs[i]);
  write_file_atomically(own + "/task.sh", script(job, maps, own));
  run_all(job, own, "map", maps);
  if (job.reduced) run_all(job, own, "reduce", options_.reduce_tasks);
  fs::rename(own + "/out", results, error);
  if (error) throw Error(results + ": cannot be renamed: " + error.message());
  write_file_atomically(results + "/_SUCCESS", "");
  fs::remove_all(own, error);
}

void FolderEngine::end_earlier(const std::string& job) {
  for (const std::string& name : store_->list(job_folder(job))) {
    if (name.starts_with("tasks-")) end_tasks(fmt::format("{}/{}/{}", store_->place(), job_folder(job), name));
  }
}

std::string FolderEngine::script(const EngineJob& job, int maps, const std::string& folder) const {
  std::string numbers;
  for (int m = 0; m < maps; ++m) numbers += fmt::format("{}{}", m > 0 ? " " : "", m);
  return fmt::format(
      fmt::runtime(kScript), fmt::arg("folder", shell_word(folder)), fmt::arg("program", shell_word(options_.program)),
      fmt::arg("command", job.command), fmt::arg("store", shell_word(store_->place())),
      fmt::arg("job", shell_word(job.name)), fmt::arg("threads", options_.task_threads),
      fmt::arg("merge", options_.combine && job.summed ? "" : "--unmerged"),
      fmt::arg("reducers", options_.reduce_tasks), fmt::arg("maps", numbers),
      fmt::arg("map", job.reduced ? "map_for_reduce" : "map_only"), fmt::arg("attempts", options_.attempts));
}

bool FolderEngine::done(const Tasks& tasks, int number) const {
  std::error_code ignored;
  return fs::exists(fmt::format("{}/{}-{}.done", tasks.folder, tasks.kind, number), ignored);
}

void FolderEngine::report(const Tasks& tasks, const std::string& waiting) const {
  JobProgress progress{tasks.job, tasks.kind + waiting, 0, tasks.all, {}};
  for (int number = 0; number < tasks.all; ++number) {
    progress.done += done(tasks, number) ? 1 : 0;
    for_lines(text_of(log_of(tasks.folder, tasks.kind, number)), [&](const std::string& line) {
      if (!line.starts_with(kCounter)) return;
      const std::size_t comma = line.rfind(',');
      progress.counters[line.substr(std::string(kCounter).size(), comma - std::string(kCounter).size())] +=
          std::strtoull(line.c_str() + comma + 1, nullptr, 10);
    });
  }
  options_.tell(progress);
  if (options_.stopped()) throw Interrupted("training: interrupted");
}

void FolderEngine::run_all(const EngineJob& job, const std::string& folder, const std::string& kind, int count) {
  Tasks tasks{job.name, folder, kind, count, {}};
  for (int number = 0; number < count; ++number) {
    if (!done(tasks, number)) tasks.numbers.push_back(number);
  }
  if (!tasks.numbers.empty()) run_tasks(tasks);
  for (const int number : tasks.numbers) {
    if (done(tasks, number)) continue;
    throw Error(fmt::format("{}: {} task {} of {} failed {} times: {}", job.name, kind, number + 1, count,
                            options_.attempts, last_words(text_of(log_of(tasks.folder, kind, number)))));
  }
  report(tasks);
}

std::unique_ptr<Engine> make_local_engine(std::unique_ptr<Store> store, const EngineOptions& options, int processes) {
  return std::make_unique<LocalEngine>(std::move(store), options, processes);
}

}  // namespace vesalius
