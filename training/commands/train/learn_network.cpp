#include "commands/train/learn_network.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include "cluster/process.h"
#include "console/default_model.h"
#include "console/interrupts.h"
#include "console/text_sink.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPackage = "vesalius_network";
constexpr std::chrono::milliseconds kPause{50};
constexpr std::chrono::minutes kMostToImport{5};  ///< from a disk that sleeps
constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;

/// Returns the folder of the tool: beside the models, in an installation as in a build.
std::string tool_folder() {
  std::error_code ignored;
  for (const std::string& models : model_folders()) {
    const fs::path folder = fs::path(models).parent_path() / "network";
    if (fs::is_directory(folder / kPackage, ignored)) return folder.string();
  }
  throw Error("the tool that learns networks is not installed: expected a folder network beside that of the models");
}

std::vector<std::string> call(const NetworkOptions& options, const NetworkRun& run) {
  std::vector<std::string> words{"env", "PYTHONPATH=" + tool_folder(), options.python, "-m", kPackage};
  words.insert(words.end(), run.frames.begin(), run.frames.end());
  const auto add = [&](const char* flag, const std::string& value) { words.insert(words.end(), {flag, value}); };
  if (!run.held_out.empty()) {
    words.emplace_back("--held-out");
    words.insert(words.end(), run.held_out.begin(), run.held_out.end());
  }
  add("--out", run.folder);
  add("--config", options.config);
  add("--views", std::to_string(options.views));
  add("--seed", std::to_string(options.seed));
  if (options.batch > 0) add("--batch", std::to_string(options.batch));
  if (options.rate > 0.F) add("--rate", fmt::format("{}", options.rate));
  if (!options.init.empty()) add("--init", options.init);
  add("--device", run.device);
  add("--threads", std::to_string(thread_count()));
  if (run.device == "cpu") add("--memory", fmt::format("{:.2f}", double(run.max_bytes) / kGiB));
  if (run.restart) words.emplace_back("--restart");
  return words;
}

/// Passes on the lines that a file has got since the last time.
class NewLines {
 public:
  NewLines(const std::string& path, bool shown) : file_(path), shown_(shown) {}

  void pass_on() {
    begun_.append(std::istreambuf_iterator<char>(file_), {});
    file_.clear();
    std::size_t begin = 0;
    for (std::size_t end; (end = begun_.find('\n', begin)) != std::string::npos; begin = end + 1) {
      last_ = begun_.substr(begin, end - begin);
      if (shown_) say(last_);
    }
    begun_.erase(0, begin);
  }
  const std::string& last() const { return last_; }

 private:
  std::ifstream file_;
  bool shown_;
  std::string begun_, last_;
};

std::string last_line(std::string text) {
  text.erase(text.find_last_not_of('\n') + 1);
  return text.substr(text.rfind('\n') + 1);
}

/// The tool reads models without their checksums.
void expect_beginning(const std::string& init) {
  const std::string ending = fs::path(init).extension();
  if (init.empty() || ending == ".npz" || ending == ".pt") return;  // weights
  if (load_model(init).network == nullptr) throw Error(init + ": expected a model whose labeller is a network");
}

}  // namespace

void expect_network_tool(const NetworkOptions& options) {
  expect_beginning(options.init);
  const std::string folder = tool_folder();
  const CommandResult tried = run_command({options.python, "-c", "import numpy, torch, zstandard"}, kMostToImport);
  if (tried.exit_code == 0) return;
  throw Error(fmt::format("{}: {}; expected in network.python a Python with what {}/requirements.txt lists",
                          options.python, last_line(tried.err), folder));
}

std::string learn_network(const NetworkOptions& options, const NetworkRun& run) {
  fs::create_directories(run.folder);
  const std::string log = run.folder + "/log", errors = run.folder + "/errors";
  ChildProcess child(call(options, run), log, errors);
  NewLines progress(log, run.shown), failures(errors, false);
  std::optional<int> code;
  while (!(code = child.ended())) {
    progress.pass_on();
    if (interrupted()) child.ask_to_end();
    std::this_thread::sleep_for(kPause);
  }
  progress.pass_on();
  failures.pass_on();
  if (interrupted()) throw Error("interrupted: the same command goes on");
  if (*code != 0) throw Error(failures.last().empty() ? "the tool failed; see " + errors : failures.last());
  return run.folder + "/network.network";
}

}  // namespace vesalius::cli
