#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "vesalius/error.h"

namespace vesalius {

/// The C functions of a library that is loaded while the program runs, each a member (VESALIUS_FUNCTION) of what
/// derives from this. The library stays loaded: threads of it may run until the end.
class RunTimeLibrary {
 protected:
  /// Loads the first of several files that is a library, or the one that `variable` of the environment names. Functions
  /// have names that begin with `prefix`. Throws Error with `name`, what is `expected` and the loader's reason where a
  /// file was named.
  RunTimeLibrary(std::string name, const std::string& expected, const char* variable, std::string prefix,
                 const std::vector<std::string>& files);
  /// Takes functions of a library that is loaded already: `handle` is what dlopen returns, or RTLD_DEFAULT.
  RunTimeLibrary(std::string name, std::string prefix, void* handle)
      : name_(std::move(name)), prefix_(std::move(prefix)), handle_(handle) {}

  /// Returns the library's function of this name. Throws Error naming the library where it has none.
  template <class Function>
  Function* find(const char* function) const {
    return reinterpret_cast<Function*>(find_address(function));
  }

 private:
  void* find_address(const char* function) const;

  std::string name_, prefix_;
  void* handle_ = nullptr;
};

/// A pointer to a function of the library: what it returns, its name without the prefix, and what it takes.
#define VESALIUS_FUNCTION(result, name, ...) result (*name)(__VA_ARGS__) = find<result(__VA_ARGS__)>(#name)

/// Receives what a C function of a library that is loaded while the program runs says, and throws it as Error. For the
/// library's type of errors there are two functions: `const char* text_of(const Failure*)` and `void free(Failure*)`.
template <class Failure>
class Outcome {
 public:
  /// `what` begins the message.
  explicit Outcome(std::string what) : what_(std::move(what)) {}
  ~Outcome() {
    if (failed()) free(failure_);
  }
  Outcome(const Outcome&) = delete;
  Outcome& operator=(const Outcome&) = delete;

  Failure** out() { return &failure_; }
  bool failed() const { return failure_ != nullptr; }
  /// Returns the library's words in one line; empty where nothing failed.
  std::string reason() const {
    std::string text = failed() ? text_of(failure_) : "";
    std::ranges::replace(text, '\n', ' ');
    return text;
  }
  void expect() const {
    if (failed()) throw Error(what_ + ": " + reason());
  }

 private:
  std::string what_;
  Failure* failure_ = nullptr;
};

/// Calls a function of such a library; the last of its arguments is where it puts an error.
template <class Result, class... Parameters, class... Given>
Result call(const std::string& what, Result (*function)(Parameters...), Given... given) {
  using Failure = std::remove_pointer_t<
      std::remove_pointer_t<std::tuple_element_t<sizeof...(Parameters) - 1, std::tuple<Parameters...>>>>;
  Outcome<Failure> outcome(what);
  if constexpr (std::is_void_v<Result>) {
    function(given..., outcome.out());
    outcome.expect();
  } else {
    Result result = function(given..., outcome.out());
    outcome.expect();
    return result;
  }
}

/// An object of such a library with the function that deletes it.
template <class T>
using Owned = std::unique_ptr<T, void (*)(T*)>;

}  // namespace vesalius
