#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace vesalius::cli {

/// Things done, rate and time left on standard error: one line that changes on a terminal, elsewhere a plain line
/// every ten seconds.
class Progress {
 public:
  /// `total` < 0: not known. Silent where not `shown`. `unit` is what is counted.
  Progress(int total, bool shown, std::string unit = "frames");
  /// Removes the changing line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void step();
  /// For work whose parts are not counted one by one, or whose total turns out on the way.
  void set(int done, int total);
  /// Removes the changing line, so that another text can be written.
  void clear();

  int done() const { return done_; }
  double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;

  int total_;
  bool shown_;
  bool terminal_;
  std::string unit_;
  int done_ = 0;
  std::size_t width_ = 0;  ///< of the line on the terminal now
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_shown_ = start_;
};

}  // namespace vesalius::cli
