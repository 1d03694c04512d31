#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace vesalius::test {

/// Returns what a command prints, and "failed" after that if it fails.
inline std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "cannot be run";
  std::array<char, 256> part{};
  while (std::fgets(part.data(), int(part.size()), pipe) != nullptr) text += part.data();
  return text + (pclose(pipe) == 0 ? "" : "failed");
}

}  // namespace vesalius::test
