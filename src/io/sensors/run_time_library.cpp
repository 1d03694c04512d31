#include "io/sensors/run_time_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>

namespace vesalius {

void* load_library(const char* variable, const std::vector<std::string>& names, const std::string& missing) {
  if (const char* given = std::getenv(variable)) {
    if (void* handle = ::dlopen(given, RTLD_NOW | RTLD_LOCAL)) return handle;
    throw Error(fmt::format("{} ({}={}: {})", missing, variable, given, ::dlerror()));
  }
  for (const std::string& name : names) {
    if (void* handle = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL)) return handle;
  }
  throw Error(missing);
}

void* find_address(void* handle, const char* library, const std::string& name) {
  void* found = ::dlsym(handle, name.c_str());
  if (found == nullptr) throw Error(fmt::format("{} has no {}, expected another version of it", library, name));
  return found;
}

}  // namespace vesalius
