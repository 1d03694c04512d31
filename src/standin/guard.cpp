#include "standin/guard.h"

#include <cstdio>
#include <exception>
#include <mutex>
#include <set>

namespace vesalius::standin {

void Guard::say_once(const std::string& what) const noexcept {
  constexpr std::size_t kMostKept = 100;
  static std::mutex mutex;
  static std::set<std::string> said;
  try {
    const std::scoped_lock lock(mutex);
    if (said.size() >= kMostKept || !said.insert(what).second) return;
    std::fprintf(stderr, "%s of vesalius: %s\n", library_, what.c_str());
  } catch (...) {  // without memory there is nothing to be said
  }
}

void Guard::say_exception(const char* function) const noexcept {
  try {
    throw;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s of vesalius: %s: %s\n", library_, function, e.what());
  } catch (...) {
    std::fprintf(stderr, "%s of vesalius: %s: an exception of unknown kind\n", library_, function);
  }
}

}  // namespace vesalius::standin
