#pragma once

#include <string>
#include <utility>

namespace vesalius::standin {

/// Stands between the functions of a library's interface and what they do: nothing that is thrown leaves, a line on the
/// error output says it.
class Guard {
 public:
  /// `library` begins the lines, e.g. "libk4abt".
  explicit constexpr Guard(const char* library) : library_(library) {}

  /// Writes a line, unless it was written before.
  void say_once(const std::string& what) const noexcept;
  /// Says what the exception that is being handled says.
  void say_exception(const char* function) const noexcept;

  /// Runs a function of the interface and returns its value, or `failed` where something is thrown.
  template <class T, class F>
  T run(const char* function, T failed, F&& work) const noexcept {
    try {
      return std::forward<F>(work)();
    } catch (...) {
      say_exception(function);
      return failed;
    }
  }

  /// The same for one without a value.
  template <class F>
  void run(const char* function, F&& work) const noexcept {
    try {
      std::forward<F>(work)();
    } catch (...) {
      say_exception(function);
    }
  }

 private:
  const char* library_;
};

}  // namespace vesalius::standin
