#include "cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace vesalius::cli {
namespace {

constexpr double kTerminalPeriod_s = 0.1;
constexpr double kPlainPeriod_s = 10.0;

}  // namespace

Progress::Progress(int total, bool shown, std::string unit)
    : total_(total), shown_(shown), terminal_(::isatty(STDERR_FILENO) == 1), unit_(std::move(unit)) {}

Progress::~Progress() { clear(); }

double Progress::seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

void Progress::clear() {
  if (width_ > 0) std::fputs(fmt::format("\r{:{}}\r", "", width_).c_str(), stderr);
  width_ = 0;
}

void Progress::step() { set(done_ + 1, total_); }

void Progress::set(int done, int total) {
  done_ = done;
  total_ = total;
  const Clock::time_point now = Clock::now();
  const double waited = std::chrono::duration<double>(now - last_shown_).count();
  if (!shown_ || waited < (terminal_ ? kTerminalPeriod_s : kPlainPeriod_s)) return;
  last_shown_ = now;
  const double rate = done_ / seconds();
  std::string line = fmt::format("{0} {1}, {2:.1f} {1}/s", done_, unit_, rate);
  if (total_ >= 0 && rate > 0.0) {
    line = fmt::format("{0} of {1} {2}, {3:.1f} {2}/s, {4:.0f} s left", done_, total_, unit_, rate,
                       (total_ - done_) / rate);
  }
  clear();
  std::fputs((line + (terminal_ ? "" : "\n")).c_str(), stderr);
  if (terminal_) width_ = line.size();
  std::fflush(stderr);
}

}  // namespace vesalius::cli
