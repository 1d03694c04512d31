#include "console/late_lines.h"

#include "console/text_sink.h"

namespace vesalius::cli {

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

}  // namespace vesalius::cli
