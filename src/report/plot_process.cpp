#include "report/plot_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <thread>

#include "vesalius/base/error.h"

extern char** environ;

namespace vesalius {
namespace {

constexpr std::size_t kMaxOutput = std::size_t{64} << 20;
constexpr auto kReapPeriod = std::chrono::milliseconds(2);

using Clock = std::chrono::steady_clock;

/// A file descriptor of ours.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int get() const { return fd_; }
  bool is_open() const { return fd_ >= 0; }
  void set(int fd) {
    close();
    fd_ = fd;
  }
  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
};

[[noreturn]] void fail(const std::string& program, const std::string& what, int reason) {
  throw Error(fmt::format("{}: {}: {}", program, what, std::strerror(reason)));
}

/// The input in a file that has no name: unlike a pipe it neither blocks nor raises a signal when nobody reads it.
void fill(Descriptor& file, const std::string& input, const std::string& program) {
  file.set(::memfd_create("input", MFD_CLOEXEC));
  if (!file.is_open()) fail(program, "no memory for its input", errno);
  for (std::size_t done = 0; done < input.size();) {
    const ssize_t written = ::write(file.get(), input.data() + done, input.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(program, "cannot hold its input", errno);
    done += static_cast<std::size_t>(written);
  }
  ::lseek(file.get(), 0, SEEK_SET);
}

void open_pipe(Descriptor& read_end, Descriptor& write_end, const std::string& program) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail(program, "no pipe", errno);
  read_end.set(ends[0]);
  write_end.set(ends[1]);
}

/// A program at work; killed and waited for when this goes.
class Child {
 public:
  Child(const std::vector<std::string>& command, const std::string& input) : program_(command.front()) {
    Descriptor in, out_end, err_end;
    fill(in, input, program_);
    open_pipe(out_, out_end, program_);
    open_pipe(err_, err_end, program_);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in.get(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out_end.get(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, err_end.get(), STDERR_FILENO);
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const int error = ::posix_spawnp(&pid_, program_.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error == ENOENT) throw Error(fmt::format("{}: not found, expected this program in PATH", program_));
    if (error != 0) fail(program_, "cannot be run", error);
  }
  ~Child() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  ProcessResult wait(Clock::time_point deadline) {
    ProcessResult result;
    while (out_.is_open() || err_.is_open()) {
      std::array<pollfd, 2> waiting{{{out_.get(), POLLIN, 0}, {err_.get(), POLLIN, 0}}};
      const int ready = ::poll(waiting.data(), waiting.size(), left_ms(deadline));
      if (ready < 0 && errno != EINTR) fail(program_, "cannot be waited for", errno);
      if (ready <= 0) continue;
      if (waiting[0].revents != 0) read_some(out_, result.out);
      if (waiting[1].revents != 0) read_some(err_, result.err);
    }
    result.exit_code = reap(deadline);
    return result;
  }

 private:
  /// Until the deadline; throws when it has passed.
  int left_ms(Clock::time_point deadline) const {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) throw Error(fmt::format("{}: did not end in time and was stopped", program_));
    return static_cast<int>(std::min<long long>(left, 1000));
  }

  void read_some(Descriptor& from, std::string& to) const {
    std::array<char, 65536> buffer;
    const ssize_t count = ::read(from.get(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) return;
    if (count <= 0) return from.close();
    to.append(buffer.data(), static_cast<std::size_t>(count));
    if (to.size() > kMaxOutput) throw Error(fmt::format("{}: wrote more than {} bytes", program_, kMaxOutput));
  }

  int reap(Clock::time_point deadline) {
    int status = 0;
    for (;;) {
      const pid_t ended = ::waitpid(pid_, &status, WNOHANG);
      if (ended == pid_) break;
      if (ended < 0 && errno != EINTR) fail(program_, "cannot be waited for", errno);
      left_ms(deadline);
      std::this_thread::sleep_for(kReapPeriod);
    }
    pid_ = -1;
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }

  std::string program_;
  Descriptor out_, err_;
  pid_t pid_ = -1;
};

}  // namespace

ProcessResult run_process(const std::vector<std::string>& command, const std::string& input, double limit_s) {
  const auto limit = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit_s));
  Child child(command, input);
  return child.wait(Clock::now() + limit);
}

}  // namespace vesalius
