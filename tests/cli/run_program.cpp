#include "run_program.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace vesalius {

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

Outcome run_program(const std::string& arguments, const std::string& environment) {
  const std::string base = testing::TempDir() + "/vesalius_run_" + std::to_string(::getpid());
  const std::string out = base + ".out";
  const std::string err = base + ".err";
  // The redirections come first, so that those in `arguments` take precedence.
  const std::string command = ">" + out + " 2>" + err + " " + environment + " '" VESALIUS_PROGRAM "' " + arguments;
  const int status = std::system(command.c_str());
  const Outcome run{WIFEXITED(status) ? WEXITSTATUS(status) : -1, bytes_of(out), bytes_of(err)};
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  return run;
}

}  // namespace vesalius
