#pragma once

#include <string>
#include <utility>

namespace vesalius::k4abt {

/// Writes a line to the error output, as this library's.
void say(const std::string& what) noexcept;
/// The same, unless that line was written before.
void say_once(const std::string& what) noexcept;

/// Says what the exception that is being handled says.
void say_exception(const char* function) noexcept;

/// Runs a function of the interface and returns its value. Nothing that it throws leaves: a line says it, and `failed`
/// is returned.
template <class T, class F>
T guarded(const char* function, T failed, F&& work) noexcept {
  try {
    return std::forward<F>(work)();
  } catch (...) {
    say_exception(function);
    return failed;
  }
}

/// The same for one without a value.
template <class F>
void guarded(const char* function, F&& work) noexcept {
  try {
    std::forward<F>(work)();
  } catch (...) {
    say_exception(function);
  }
}

}  // namespace vesalius::k4abt
