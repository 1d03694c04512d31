#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "vesalius/base/error.h"

namespace vesalius {

/// Loads the first of several files that is a library, or the one that `variable` of the environment names, and returns
/// its handle. It stays loaded: threads of it may run until the end. Throws Error with `missing`, and the loader's
/// reason where a file was named.
void* load_library(const char* variable, const std::vector<std::string>& names, const std::string& missing);

/// Returns the address of a function. Throws Error naming `library` where it has none of this name.
void* find_address(void* handle, const char* library, const std::string& name);

/// Sets `function` to the library's function of this name. Throws Error as `find_address` does.
template <class Function>
void find_function(void* handle, const char* library, const std::string& name, Function& function) {
  function = reinterpret_cast<Function>(find_address(handle, library, name));
}

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
