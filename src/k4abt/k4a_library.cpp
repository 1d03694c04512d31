#include "k4abt/k4a_library.h"

#include <dlfcn.h>
#include <link.h>

#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/error.h"

namespace vesalius::k4abt {
namespace {

constexpr const char* kOneOfIts = "k4a_image_create";

/// Returns the paths of loaded libraries whose names begin as libk4a's do; Python's and C#'s are visible to nobody
/// else.
std::vector<std::string> loaded_libraries() {
  std::vector<std::string> paths;
  const auto look = [](dl_phdr_info* info, std::size_t, void* to) {
    const std::string_view path = info->dlpi_name != nullptr ? info->dlpi_name : "";
    const std::string_view name = path.substr(path.rfind('/') + 1);
    if (name.starts_with("libk4a") && !name.starts_with("libk4abt")) {
      static_cast<std::vector<std::string>*>(to)->emplace_back(path);
    }
    return 0;
  };
  dl_iterate_phdr(look, &paths);
  return paths;
}

void* opened(const std::string& path, int more = 0) { return ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | more); }

void* find_library() {
  if (const char* named = std::getenv("VESALIUS_K4A"); named != nullptr && *named != '\0') {
    if (void* handle = opened(named)) return handle;
    throw Error(std::string("VESALIUS_K4A=") + named + ": " + ::dlerror());
  }
  if (::dlsym(RTLD_DEFAULT, kOneOfIts) != nullptr) return RTLD_DEFAULT;
  for (const std::string& path : loaded_libraries()) {
    void* handle = opened(path, RTLD_NOLOAD);
    if (handle != nullptr && ::dlsym(handle, kOneOfIts) != nullptr) return handle;
  }
  for (const char* name : {"libk4a.so.1.4", "libk4a.so"}) {
    if (void* handle = opened(name)) return handle;
  }
  throw Error("no libk4a: expected one that the program has loaded, libk4a.so.1.4, or its path in VESALIUS_K4A");
}

}  // namespace

const K4aLibrary& k4a() {
  static const K4aLibrary library(find_library());  // tried again where that throws
  return library;
}

}  // namespace vesalius::k4abt
