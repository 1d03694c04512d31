#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace vesalius::cli {

/// What is going on, on standard error: on a terminal one line that changes and is cut to the terminal's width,
/// elsewhere a plain line every ten seconds.
class StatusLine {
 public:
  /// Silent where not `shown`.
  explicit StatusLine(bool shown);
  /// Removes the changing line.
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  bool shown() const { return shown_; }
  /// Whether it is time for a new line: making one may cost something.
  bool due() const;
  /// Shows it, due or not.
  void show(const std::string& line);
  /// Removes the changing line, so that another text can be written.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_;
  bool terminal_;
  std::size_t width_ = 0;  ///< of the line on the terminal now
  Clock::time_point last_shown_ = Clock::now();
};

}  // namespace vesalius::cli
