#pragma once

#include <chrono>
#include <cstddef>
#include <string>

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

}  // namespace vesalius::cli
