#include "standin/program_library.h"

#include <dlfcn.h>
#include <link.h>

#include <cstdlib>
#include <string_view>

#include "vesalius/error.h"

namespace vesalius::standin {
namespace {

struct Search {
  const ProgramLibrary& library;
  std::vector<std::string> paths;
};

/// Returns the paths of loaded libraries of that name; Python's and C#'s are visible to nobody else.
std::vector<std::string> loaded_libraries(const ProgramLibrary& library) {
  Search search{library, {}};
  const auto look = [](dl_phdr_info* info, std::size_t, void* to) {
    auto& [of, paths] = *static_cast<Search*>(to);
    const std::string_view path = info->dlpi_name != nullptr ? info->dlpi_name : "";
    const std::string_view name = path.substr(path.rfind('/') + 1);
    if (name.starts_with(of.name) && (of.but.empty() || !name.starts_with(of.but))) paths.emplace_back(path);
    return 0;
  };
  dl_iterate_phdr(look, &search);
  return std::move(search.paths);
}

void* opened(const std::string& path, int more = 0) { return ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | more); }

}  // namespace

void* find_program_library(const ProgramLibrary& library) {
  if (const char* named = std::getenv(library.variable); named != nullptr && *named != '\0') {
    if (void* handle = opened(named)) return handle;
    throw Error(std::string(library.variable) + "=" + named + ": " + ::dlerror());
  }
  if (::dlsym(RTLD_DEFAULT, library.function) != nullptr) return RTLD_DEFAULT;
  for (const std::string& path : loaded_libraries(library)) {
    void* handle = opened(path, RTLD_NOLOAD);
    if (handle != nullptr && ::dlsym(handle, library.function) != nullptr) return handle;
  }
  for (const std::string& name : library.files) {
    if (void* handle = opened(name)) return handle;
  }
  throw Error("no " + library.name + ": expected one that the program has loaded, " + library.files.front() +
              ", or its path in " + library.variable);
}

}  // namespace vesalius::standin
