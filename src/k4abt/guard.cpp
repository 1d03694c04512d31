#include "k4abt/guard.h"

#include <cstdio>
#include <exception>
#include <mutex>
#include <set>

namespace vesalius::k4abt {

void say(const std::string& what) noexcept { std::fprintf(stderr, "libk4abt of vesalius: %s\n", what.c_str()); }

void say_once(const std::string& what) noexcept {
  constexpr std::size_t kMostKept = 100;
  static std::mutex mutex;
  static std::set<std::string> said;
  try {
    const std::scoped_lock lock(mutex);
    if (said.size() < kMostKept && said.insert(what).second) say(what);
  } catch (...) {  // without memory there is nothing to be said
  }
}

void say_exception(const char* function) noexcept {
  try {
    throw;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "libk4abt of vesalius: %s: %s\n", function, e.what());
  } catch (...) {
    std::fprintf(stderr, "libk4abt of vesalius: %s: an exception of unknown kind\n", function);
  }
}

}  // namespace vesalius::k4abt
