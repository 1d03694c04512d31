#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/error.h"
#include "vesalius/vesalius.h"

namespace vesalius::c {

/// A buffer of the caller's that is too small.
class CapacityError : public Error {
 public:
  using Error::Error;
};

/// Keeps what the exception that is being handled says as this thread's last error, one line. Returns its status.
vesalius_status keep_exception() noexcept;

/// Returns this thread's last error.
const char* last_error() noexcept;

/// Runs a function of the interface: nothing that it throws leaves.
template <class F>
vesalius_status guarded(F&& work) noexcept {
  try {
    std::forward<F>(work)();
    return VESALIUS_OK;
  } catch (...) {
    return keep_exception();
  }
}

/// The same for a function that returns a value, and `failed` where it cannot.
template <class T, class F>
T guarded_value(T failed, F&& work) noexcept {
  guarded([&] { failed = std::forward<F>(work)(); });
  return failed;
}

/// Throws UsageError for NULL.
template <class T>
T& need(T* pointer, const char* name) {
  if (pointer == nullptr) throw UsageError(std::string(name) + " is NULL");
  return *pointer;
}

/// Returns an element of a list. Throws UsageError for an index that is not there.
template <class T>
const T& at(const std::vector<T>& list, std::int32_t index, const char* name) {
  if (index >= 0 && static_cast<std::size_t>(index) < list.size()) return list[static_cast<std::size_t>(index)];
  throw UsageError(std::string(name) + " " + std::to_string(index) + " is not there, expected one of " +
                   std::to_string(list.size()) + " from 0");
}

}  // namespace vesalius::c
