#include "cluster/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <thread>
#include <utility>

#include "folders/owned_folder.h"
#include "io/files/data_file.h"
#include "vesalius/error.h"

extern char** environ;

namespace vesalius {
namespace {

constexpr std::chrono::milliseconds kPause{5};

int code_of(int status) { return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status); }

/// Starts a program in a group of its own, with the default action for signals that we ignore.
pid_t start(const std::vector<std::string>& arguments, const std::string& out, const std::string& err) {
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (err == out) {
    posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  } else {
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGPIPE);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  pid_t pid = -1;
  const int error = ::posix_spawnp(&pid, words.front(), &files, &attributes, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw Error(arguments.front() + ": cannot be started: " + std::strerror(error));
  return pid;
}

}  // namespace

CommandResult run_command(const std::vector<std::string>& arguments, std::chrono::duration<double> limit) {
  const TemporaryFolder files;
  ChildProcess child(arguments, files.path("out"), files.path("err"));
  const auto begun = std::chrono::steady_clock::now();
  std::optional<int> code;
  while (!(code = child.ended())) {
    if (std::chrono::steady_clock::now() - begun > limit) {
      child.kill();
      return {128 + SIGKILL, "", fmt::format("{} does not answer within {:g} s", arguments.front(), limit.count()),
              false};
    }
    std::this_thread::sleep_for(kPause);
  }
  return {*code, read_file(files.path("out")), read_file(files.path("err"))};
}

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, const std::string& output,
                           const std::string& errors)
    : pid_(start(arguments, output, errors)) {}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}

ChildProcess::~ChildProcess() { kill(); }

std::optional<int> ChildProcess::ended() {
  int status = 0;
  if (pid_ < 0 || ::waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
  pid_ = -1;
  return code_of(status);
}

void ChildProcess::ask_to_end() const {
  if (pid_ >= 0) ::kill(-pid_, SIGTERM);
}

void ChildProcess::kill() {
  if (pid_ < 0) return;
  ::kill(-pid_, SIGKILL);
  int status = 0;
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
}

}  // namespace vesalius
