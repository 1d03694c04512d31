#include "report/plot_process.h"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <thread>

#include "vesalius/base/error.h"

extern char** environ;

namespace vesalius {
namespace {

constexpr off_t kMaxOutput = off_t{64} << 20;
constexpr auto kPeriod = std::chrono::milliseconds(2);

using Clock = std::chrono::steady_clock;
struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
/// A file without a name. Unlike a pipe, it neither blocks nor raises a signal if the other side does not use it.
using File = std::unique_ptr<std::FILE, Close>;

File temporary_file(const std::string& content = "") {
  File file(std::tmpfile());
  const bool written = file && std::fwrite(content.data(), 1, content.size(), file.get()) == content.size() &&
                       std::fflush(file.get()) == 0;
  if (!written) throw Error(fmt::format("no temporary file: {}", std::strerror(errno)));
  std::rewind(file.get());
  return file;
}

off_t size_of(std::FILE* file) {
  struct stat status {};
  return ::fstat(::fileno(file), &status) == 0 ? status.st_size : 0;
}

std::string text_of(std::FILE* file) {
  std::string text(static_cast<std::size_t>(size_of(file)), '\0');
  std::rewind(file);
  text.resize(std::fread(text.data(), 1, text.size(), file));
  return text;
}

pid_t start(const std::vector<std::string>& command, std::FILE* in, std::FILE* out, std::FILE* err) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(in), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(out), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(err), STDERR_FILENO);
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t pid = -1;
  const int error = ::posix_spawnp(&pid, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) throw Error(fmt::format("{}: not found, expected this program in PATH", command[0]));
  if (error != 0) throw Error(fmt::format("{}: cannot be run: {}", command[0], std::strerror(error)));
  return pid;
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& command, const std::string& input, double limit_s) {
  const File in = temporary_file(input), out = temporary_file(), err = temporary_file();
  const auto deadline = Clock::now() + std::chrono::duration<double>(limit_s);
  const pid_t pid = start(command, in.get(), out.get(), err.get());
  int status = 0;
  while (::waitpid(pid, &status, WNOHANG) == 0) {
    const bool too_long = Clock::now() > deadline;
    if (too_long || size_of(out.get()) + size_of(err.get()) > kMaxOutput) {
      ::kill(pid, SIGKILL);
      ::waitpid(pid, nullptr, 0);
      throw Error(too_long ? fmt::format("{}: did not end in time and was stopped", command[0])
                           : fmt::format("{}: wrote more than {} bytes", command[0], kMaxOutput));
    }
    std::this_thread::sleep_for(kPeriod);
  }
  return {WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), text_of(out.get()), text_of(err.get())};
}

}  // namespace vesalius
