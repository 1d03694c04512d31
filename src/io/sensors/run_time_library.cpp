#include "io/sensors/run_time_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>

namespace vesalius {

RunTimeLibrary::RunTimeLibrary(std::string name, const std::string& expected, const char* variable, std::string prefix,
                               const std::vector<std::string>& files)
    : name_(std::move(name)), prefix_(std::move(prefix)) {
  const std::string missing = fmt::format("{} is not installed, {} (docs/cameras.md)", name_, expected);
  const auto load = [this](const std::string& file) { handle_ = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL); };
  if (const char* given = std::getenv(variable)) {
    load(given);
    if (handle_ == nullptr) throw Error(fmt::format("{} ({}={}: {})", missing, variable, given, ::dlerror()));
  }
  for (auto file = files.begin(); handle_ == nullptr && file != files.end(); ++file) load(*file);
  if (handle_ == nullptr) throw Error(missing);
}

void* RunTimeLibrary::find_address(const char* function) const {
  void* found = ::dlsym(handle_, (prefix_ + function).c_str());
  if (found == nullptr) {
    throw Error(fmt::format("{} has no {}{}, expected another version of it", name_, prefix_, function));
  }
  return found;
}

}  // namespace vesalius
