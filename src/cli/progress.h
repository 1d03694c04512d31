#pragma once

#include <chrono>
#include <string>

#include "cli/status_line.h"

namespace vesalius::cli {

/// Things done, rate and time left as a StatusLine.
class Progress {
 public:
  /// `total` < 0: not known. Silent where not `shown`. `unit` is what is counted.
  Progress(int total, bool shown, std::string unit = "frames");

  void step();
  /// For work whose parts are not counted one by one, or whose total turns out on the way.
  void set(int done, int total);
  /// Removes the changing line, so that another text can be written.
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
