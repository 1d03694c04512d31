#include "console/status_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

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

}  // namespace vesalius::cli
