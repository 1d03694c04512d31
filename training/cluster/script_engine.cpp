#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <random>
#include <thread>
#include <utility>

#include "cluster/engine.h"
#include "cluster/folder_engine.h"
#include "cluster/process.h"
#include "cluster/train_job.h"
#include "io/files/data_file.h"
#include "train/messages/training_protocol.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPause{100};

class ScriptEngine : public Engine {
 public:
  ScriptEngine(std::unique_ptr<Store> store, EngineOptions options, std::string script)
      : store_(std::move(store)), options_(std::move(options)), script_(std::move(script)) {}

  Store& store() override { return *store_; }

  void run(const EngineJob& job) override {
    // What a killed driver left behind may still be running: nothing of it counts, and it has a folder of its own.
    const std::string folder = job_folder(job.name), out = fmt::format("{}/out-{:08x}", folder, std::random_device()());
    for (const std::string& name : store_->list(folder)) {
      if (name.starts_with("out")) store_->remove(folder + "/" + name);
    }
    const std::vector<std::string> inputs = inputs_of(job, options_.map_tasks);
    store_->write(folder + "/lines", fmt::format("{}", fmt::join(inputs, "")));
    wait_for(job.name, command_of(job, path_of(out), inputs.size()), path_of(folder + "/script.log"));
    if (std::ranges::none_of(store_->list(out), [](const std::string& file) { return file.starts_with("part-"); })) {
      throw Error(fmt::format("{}: {} left no file part-* in {}", job.name, script_, path_of(out)));
    }
    fs::rename(path_of(out), path_of(result_folder(job.name)));
    store_->write(result_folder(job.name) + "/_SUCCESS", "");
  }

 private:
  std::string path_of(const std::string& name) const { return store_->place() + "/" + name; }

  std::vector<std::string> command_of(const EngineJob& job, const std::string& out, std::size_t maps) const {
    const std::string program = shell_word(options_.program);
    const auto task = [&](const char* kind) {
      return fmt::format("{} {} {} --store {} --job {} --threads {}", program, job.command, kind,
                         shell_word(store_->place()), shell_word(job.name), options_.task_threads);
    };
    std::string map = task("map");
    if (job.summed && options_.combine) {
      map += fmt::format(" | LC_ALL=C sort -S 128M | {} train combine", program);
      map = "bash -o pipefail -c " + shell_word(map);
    }
    std::vector<std::string> command{"env"};
    const auto set = [&](const char* name, const auto& value) { command.push_back(fmt::format("{}={}", name, value)); };
    set("VESALIUS_JOB", job.name);
    set("VESALIUS_MAP", map);
    set("VESALIUS_REDUCE", job.reduced ? task("reduce") : "");
    set("VESALIUS_MAP_TASKS", maps);
    set("VESALIUS_REDUCE_TASKS", job.reduced ? options_.reduce_tasks : 0);
    set("VESALIUS_TASK_THREADS", options_.task_threads);
    // env would take a path with '=' for a variable.
    const std::string lines = path_of(job_folder(job.name) + "/lines");
    command.insert(command.end(), {"bash", "-c", R"(exec "$0" "$@")", script_, lines, out});
    command.insert(command.end(), options_.arguments.begin(), options_.arguments.end());
    return command;
  }

  void wait_for(const std::string& job, const std::vector<std::string>& command, const std::string& log) const {
    ChildProcess child(command, log);
    std::optional<int> code;
    while (!(code = child.ended())) {
      options_.tell({job, fs::path(script_).filename().string(), 0, 1, {}});
      if (options_.stopped()) throw Interrupted("training: interrupted");
      std::this_thread::sleep_for(kPause);
    }
    if (*code != 0) throw Error(fmt::format("{}: {} failed: {}", job, script_, last_words(read_file(log))));
  }

  std::unique_ptr<Store> store_;
  EngineOptions options_;
  std::string script_;
};

}  // namespace

std::unique_ptr<Engine> make_script_engine(std::unique_ptr<Store> store, const EngineOptions& options,
                                           const std::string& script) {
  return std::make_unique<ScriptEngine>(std::move(store), options, script);
}

}  // namespace vesalius
