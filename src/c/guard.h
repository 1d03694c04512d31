#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
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

/// A structure larger than this is taken for one whose struct_size was never set.
inline constexpr std::uint32_t kLargestStruct = 4096;

/// Throws UsageError unless struct_size is that of a version of the structure. `first` is the size in the first one.
inline std::uint32_t check_struct_size(std::uint32_t size, std::size_t first, const char* name) {
  if (size >= first && size <= kLargestStruct) return size;
  throw UsageError(std::string(name) + ": struct_size is " + std::to_string(size) + ", expected " +
                   std::to_string(first) + ", sizeof the structure");
}

/// Returns a structure that a program gives, which may have been compiled with an older header, whose structure was
/// smaller, or with a newer one: then what this library does not know must be 0. Throws UsageError.
template <class T>
T read_struct(const T* given, const char* name, std::size_t first = sizeof(T)) {
  const std::uint32_t size = check_struct_size(need(given, name).struct_size, first, name);
  T known{};
  std::memcpy(&known, given, std::min<std::size_t>(size, sizeof(T)));
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (size > sizeof(T) && std::any_of(bytes + sizeof(T), bytes + size, [](unsigned char byte) { return byte != 0; })) {
    throw UsageError(std::string(name) + ": it has something set that this version of the library does not know");
  }
  return known;
}

/// Writes as much of a structure as the program's version of it has, and 0 to what only that has. Throws UsageError.
template <class T>
void write_struct(T values, T* to, const char* name, std::size_t first = sizeof(T)) {
  const std::uint32_t size = check_struct_size(need(to, name).struct_size, first, name);
  values.struct_size = size;
  std::memset(to, 0, size);
  std::memcpy(to, &values, std::min<std::size_t>(size, sizeof(T)));
}

}  // namespace vesalius::c
