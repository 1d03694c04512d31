#include "console/machine_facts.h"

#include <fmt/format.h>

#include <fstream>

#include "console/text_sink.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

std::string processor() {
  std::ifstream facts("/proc/cpuinfo");
  std::string line;
  while (std::getline(facts, line)) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != line.npos) return one_line(line.substr(colon + 2));
  }
  return "unknown processor";
}

}  // namespace

std::string machine_facts() {
#if defined(__clang__)
  const char* compiler = "clang " __clang_version__;
#else
  const char* compiler = "gcc " __VERSION__;
#endif
  return fmt::format("{}, {} threads, {}, {}", processor(), thread_count(), compiler, VESALIUS_BUILD_TYPE);
}

}  // namespace vesalius::cli
