#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "console/progress.h"

namespace vesalius::cli {

/// Lines for standard error that another thread has, kept until the one that shows the progress prints them: on a
/// terminal both would get into one row.
class LateLines {
 public:
  /// May be called from any thread.
  void add(const std::string& line);
  /// Prints what has come.
  void print(Progress& progress);

 private:
  std::mutex mutex_;
  std::vector<std::string> lines_;
};

}  // namespace vesalius::cli
