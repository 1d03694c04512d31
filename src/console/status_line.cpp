#include "console/status_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "console/text_sink.h"
#include "io/files/plain_text.h"

namespace vesalius::cli {
namespace {

constexpr std::chrono::milliseconds kTerminalPeriod(100);
constexpr std::chrono::seconds kPlainPeriod(10);

/// Returns the length that a line may have on the terminal. A line that filled the last column would wrap, and its
/// first row could not be removed any more.
std::size_t terminal_width() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col - 1U : 79U;
}

}  // namespace

StatusLine::StatusLine(bool shown) : shown_(shown), terminal_(::isatty(STDERR_FILENO) == 1) {}

StatusLine::~StatusLine() { clear(); }

bool StatusLine::due() const {
  const Clock::duration waited = Clock::now() - last_shown_;
  return shown_ && (terminal_ ? waited >= kTerminalPeriod : waited >= kPlainPeriod);
}

void StatusLine::show(const std::string& line) {
  if (!shown_) return;
  last_shown_ = Clock::now();
  clear();
  const std::string text = terminal_ ? line.substr(0, terminal_width()) : line + "\n";
  std::fputs(text.c_str(), stderr);
  if (terminal_) width_ = text.size();
  std::fflush(stderr);
}

void StatusLine::clear() {
  if (width_ > 0) std::fputs(fmt::format("\r{:{}}\r", "", width_).c_str(), stderr);
  width_ = 0;
}

void LateLines::add(const std::string& line) {
  const std::scoped_lock lock(mutex_);
  lines_.push_back(line);
}

void LateLines::print(Progress& progress) {
  std::vector<std::string> lines;
  {
    const std::scoped_lock lock(mutex_);
    lines.swap(lines_);
  }
  if (!lines.empty()) progress.clear();
  for (const std::string& line : lines) say("vesalius: " + one_line(line));
}

Progress::Progress(int total, bool shown, std::string unit, std::string units)
    : total_(total), line_(shown), unit_(std::move(unit)), units_(std::move(units)) {}

double Progress::seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

void Progress::step() { set(done_ + 1, total_); }

void Progress::set(int done, int total) {
  done_ = done;
  total_ = total;
  if (!line_.due()) return;
  const double rate = done_ / seconds();
  std::string line = fmt::format("{}, {:.1f} {}/s", counted(done_, unit_, units_), rate, units_);
  if (total_ >= 0 && rate > 0.0) {
    line = fmt::format("{0} of {1} {2}, {3:.1f} {2}/s, {4:.0f} s left", done_, total_, units_, rate,
                       (total_ - done_) / rate);
  }
  line_.show(line);
}

}  // namespace vesalius::cli
