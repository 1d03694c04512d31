#pragma once

#include <string>
#include <vector>

namespace vesalius {

struct ProcessResult {
  int exit_code = 0;  ///< exit status, or 128 + signal if a signal ended the program
  std::string out;    ///< standard output
  std::string err;    ///< standard error
};

/// Runs a program found in PATH with `input` as its standard input, and waits for its end. Throws Error naming the
/// program if it is not found, writes more than 64 MiB, or has not ended within `limit_s` seconds; in the last two
/// cases it is killed.
ProcessResult run_process(const std::vector<std::string>& command, const std::string& input, double limit_s);

}  // namespace vesalius
