#pragma once

#include <chrono>
#include <string>

#include "console/status_line.h"

namespace vesalius::cli {

/// Shows the number of finished items, the rate and the time left on a StatusLine.
class Progress {
 public:
  /// A negative `total` means that it is not known. Nothing is shown if `shown` is false. `unit` names the items.
  Progress(int total, bool shown, std::string unit = "frames");

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
  std::string unit_;
  int done_ = 0;
  Clock::time_point start_ = Clock::now();
};

}  // namespace vesalius::cli
