#include "console/progress.h"

#include <fmt/format.h>

#include <utility>

namespace vesalius::cli {

Progress::Progress(int total, bool shown, std::string unit) : total_(total), line_(shown), unit_(std::move(unit)) {}

double Progress::seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

void Progress::step() { set(done_ + 1, total_); }

void Progress::set(int done, int total) {
  done_ = done;
  total_ = total;
  if (!line_.due()) return;
  const double rate = done_ / seconds();
  std::string line = fmt::format("{0} {1}, {2:.1f} {1}/s", done_, unit_, rate);
  if (total_ >= 0 && rate > 0.0) {
    line = fmt::format("{0} of {1} {2}, {3:.1f} {2}/s, {4:.0f} s left", done_, total_, unit_, rate,
                       (total_ - done_) / rate);
  }
  line_.show(line);
}

}  // namespace vesalius::cli
