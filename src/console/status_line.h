#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace vesalius::cli {

/// Shows progress on standard error. On a terminal this is one line that changes and is cut to the terminal's width;
/// elsewhere a plain line is printed every ten seconds.
class StatusLine {
 public:
  /// Nothing is shown if `shown` is false.
  explicit StatusLine(bool shown);
  /// Removes the changing line.
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  bool shown() const { return shown_; }
  /// Returns whether it is time for a new line. Callers ask first because composing a line may be costly.
  bool due() const;
  /// Shows the line, whether it is due or not.
  void show(const std::string& line);
  /// Removes the changing line so that another text can be written.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_;
  bool terminal_;
  std::size_t width_ = 0;  ///< length of the line that the terminal shows
  Clock::time_point last_shown_ = Clock::now();
};

/// Shows the number of finished items, the rate and the time left on a StatusLine.
class Progress {
 public:
  /// A negative `total` means that it is not known. Nothing is shown if `shown` is false. `unit` and `units` name one
  /// item and several.
  Progress(int total, bool shown, std::string unit = "frame", std::string units = "frames");

  void step();
  /// Sets both numbers, for work whose items are not counted one by one or whose total becomes known later.
  void set(int done, int total);
  /// Removes the changing line so that another text can be written.
  void clear() { line_.clear(); }

  int done() const { return done_; }
  double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;

  int total_;
  StatusLine line_;
  std::string unit_, units_;
  int done_ = 0;
  Clock::time_point start_ = Clock::now();
};

/// Lines for standard error that another thread has, kept until the one that shows the progress prints them: on a
/// terminal both would get into one row.
class LateLines {
 public:
  /// May be called from any thread.
  void add(const std::string& line);
  /// Prints what has come.
  void print(Progress& progress);

 private:
  std::mutex mutex_;
  std::vector<std::string> lines_;
};

}  // namespace vesalius::cli
