#pragma once

#include <string>

namespace vesalius {

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// Runs `vesalius ARGUMENTS` by the shell, with `environment` ("NAME=value ...") set. What the arguments redirect is
/// not in the result.
Outcome run_program(const std::string& arguments, const std::string& environment = "");

/// Bytes of a file, empty where there is none.
std::string bytes_of(const std::string& path);

}  // namespace vesalius
