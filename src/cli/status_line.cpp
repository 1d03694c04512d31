#include "cli/status_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace vesalius::cli {
namespace {

constexpr std::chrono::milliseconds kTerminalPeriod(100);
constexpr std::chrono::seconds kPlainPeriod(10);

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
  std::fputs((line + (terminal_ ? "" : "\n")).c_str(), stderr);
  if (terminal_) width_ = line.size();
  std::fflush(stderr);
}

void StatusLine::clear() {
  if (width_ > 0) std::fputs(fmt::format("\r{:{}}\r", "", width_).c_str(), stderr);
  width_ = 0;
}

}  // namespace vesalius::cli
