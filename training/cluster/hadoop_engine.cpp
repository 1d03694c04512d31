#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "cluster/engine.h"
#include "cluster/folder_engine.h"
#include "cluster/process.h"
#include "cluster/train_job.h"
#include "folders/owned_folder.h"
#include "io/files/data_file.h"
#include "train/messages/training_protocol.h"

namespace vesalius {
namespace {

constexpr std::chrono::milliseconds kPause{200};
constexpr int kReportEvery = 5;  ///< pauses
constexpr const char* kRunning = "Running job: ";

/// Returns the path in HDFS of an address webhdfs://HOST:PORT/PATH.
std::string hdfs_path(const std::string& place) {
  const std::size_t host = std::string_view("webhdfs://").size();
  const std::size_t slash = place.find('/', host);
  return slash == std::string::npos ? "" : place.substr(slash);
}

/// Returns the number before the percent sign behind the last `word` of a log, e.g. of "map 33% reduce 0%"; 0 if there
/// is none.
int percent_of(const std::string& log, const std::string& word) {
  const std::size_t at = log.rfind(word);
  return at == std::string::npos ? 0 : std::atoi(log.c_str() + at + word.size());
}

/// Hadoop's own name of the job that a client's log tells of; empty before it does.
std::string job_id_of(const std::string& log) {
  const std::size_t at = log.find(kRunning);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + std::string_view(kRunning).size();
  const std::size_t end = log.find_first_of(" \r\n", begin);
  return end == std::string::npos ? "" : log.substr(begin, end - begin);
}

class HadoopEngine : public Engine {
 public:
  HadoopEngine(std::unique_ptr<Store> store, EngineOptions options)
      : store_(std::move(store)), options_(std::move(options)) {}

  Store& store() override { return *store_; }

  void run(const EngineJob& job) override {
    const std::string folder = job_folder(job.name);
    end_earlier(job.name);
    for (const char* part : {"/out", "/failed"}) store_->remove(folder + part);
    const std::vector<std::string> inputs = inputs_of(job, options_.map_tasks);
    store_->write(folder + "/in/lines", fmt::format("{}", fmt::join(inputs, "")));  // tasks take neighbours
    const TemporaryFolder logs;
    wait_for(job, folder, logs.path("client.log"), (job.lines.size() + inputs.size() - 1) / inputs.size());
  }

  void end_earlier(const std::string& job) override {
    const std::string file = job_folder(job) + "/hadoop-job";
    if (!store_->exists(file)) return;
    const CommandResult result = kill_job(store_->read(file));
    if (!result.in_time) throw Error("Hadoop: " + result.err);
    store_->remove(file);
  }

 private:
  CommandResult kill_job(const std::string& id) const {
    return run_command({"mapred", "job", "-kill", id}, std::chrono::duration<double>(options_.answer_s));
  }

  std::vector<std::string> command_of(const EngineJob& job, const std::string& folder, std::size_t lines) const {
    const std::string path = hdfs_path(store_->place()) + "/" + folder;
    const auto task = [&](const char* kind) {
      return fmt::format("{} {} {} --store {} --job {} --threads {}", options_.program, job.command, kind,
                         store_->place(), job.name, options_.task_threads);
    };
    std::vector<std::string> command{"mapred", "streaming"};
    const auto set = [&](const std::string& name, const auto& value) {
      command.insert(command.end(), {"-D", fmt::format("{}={}", name, value)});
    };
    set("mapreduce.job.name", "vesalius-" + job.name);
    set("mapreduce.job.reduces", job.reduced ? options_.reduce_tasks : 0);
    set("mapreduce.input.lineinputformat.linespermap", lines);
    set("stream.map.input.ignoreKey", "true");
    set("mapreduce.map.maxattempts", options_.attempts);
    set("mapreduce.reduce.maxattempts", options_.attempts);
    set("mapreduce.map.cpu.vcores", options_.task_threads);
    set("mapreduce.task.timeout", 3'600'000);  // a task that grows subtrees says nothing meanwhile
    command.insert(command.end(), options_.arguments.begin(), options_.arguments.end());
    command.insert(command.end(), {"-inputformat", "org.apache.hadoop.mapred.lib.NLineInputFormat", "-input",
                                   path + "/in", "-output", path + "/out", "-mapper", task("map")});
    if (job.reduced) {
      if (options_.combine && job.summed)
        command.insert(command.end(), {"-combiner", options_.program + " train combine"});
      command.insert(command.end(), {"-reducer", task("reduce")});
    }
    return command;
  }

  void wait_for(const EngineJob& job, const std::string& folder, const std::string& log_file, std::size_t lines) {
    ChildProcess client(command_of(job, folder, lines), log_file);
    std::string id;
    std::optional<int> code;
    for (int pause = 0; !(code = client.ended()); ++pause) {
      if (options_.stopped()) {
        client.kill();
        if (!id.empty()) kill_job(id);
        throw Interrupted("training: interrupted");
      }
      if (pause % kReportEvery == 0) {
        const std::string log = read_file(log_file);
        if (id.empty() && !(id = job_id_of(log)).empty()) store_->write(folder + "/hadoop-job", id);
        report(job, log);
      }
      std::this_thread::sleep_for(kPause);
    }
    if (*code != 0) throw Error(fmt::format("{}: Hadoop gave up: {}", job.name, cause_of(folder, read_file(log_file))));
    store_->remove(folder + "/hadoop-job");
  }

  void report(const EngineJob& job, const std::string& log) const {
    const int maps = percent_of(log, " map "), reduces = percent_of(log, " reduce ");
    const bool mapping = maps < 100 || !job.reduced;
    options_.tell({job.name, mapping ? "map, percent" : "reduce, percent", mapping ? maps : reduces, 100, {}});
  }

  /// Returns what a task wrote when it failed, or else why nothing can be written, or else what Hadoop's client says.
  std::string cause_of(const std::string& folder, const std::string& log) const {
    const std::vector<std::string> failed = store_->list(folder + "/failed");
    if (!failed.empty()) return store_->read(folder + "/failed/" + failed.back());
    try {
      store_->write(folder + "/failed/driver", "-");
    } catch (const Error& e) {
      return e.what();
    }
    std::string cause;
    for (const char* word : {"Exception: ", "ERROR ", "failed with state"}) {
      const std::size_t at = log.find(word);
      if (at == std::string::npos) continue;
      const std::size_t begin = log.rfind('\n', at) + 1;
      cause = log.substr(begin, log.find('\n', at) - begin);
      break;
    }
    return cause.empty() ? last_words(log) : cause;
  }

  std::unique_ptr<Store> store_;
  EngineOptions options_;
};

}  // namespace

std::unique_ptr<Engine> make_hadoop_engine(std::unique_ptr<Store> store, const EngineOptions& options) {
  return std::make_unique<HadoopEngine>(std::move(store), options);
}

}  // namespace vesalius
