#pragma once

#include <string>

namespace vesalius {

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// Runs `vesalius ARGUMENTS` in a shell with `environment` ("NAME=value ...") set. Output that the arguments redirect
/// is not in the result.
Outcome run_program(const std::string& arguments, const std::string& environment = "");

/// Returns the bytes of a file; empty if it does not exist.
std::string bytes_of(const std::string& path);

}  // namespace vesalius
