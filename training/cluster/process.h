#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace vesalius {

/// What a program that has ended left.
struct CommandResult {
  int exit_code = 0;  ///< 128 and the signal if one ended it
  std::string out, err;
  bool in_time = true;  ///< if not, it was killed, and `err` says so
};

/// Runs a program and waits for it, at most for `limit`. Throws Error if it cannot be started.
CommandResult run_command(const std::vector<std::string>& arguments, std::chrono::duration<double> limit);

/// A program that runs meanwhile, in a process group of its own. Its output goes to a file, or to two. The destructor
/// kills the whole group if it still runs.
class ChildProcess {
 public:
  /// Throws Error if it cannot be started.
  ChildProcess(const std::vector<std::string>& arguments, const std::string& output, const std::string& errors);
  ChildProcess(const std::vector<std::string>& arguments, const std::string& output)
      : ChildProcess(arguments, output, output) {}
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;

  /// Returns the exit code once it has ended.
  std::optional<int> ended();
  /// Asks the whole group to end (SIGTERM).
  void ask_to_end() const;
  void kill();

 private:
  pid_t pid_ = -1;
};

}  // namespace vesalius
