#pragma once

#include <stdexcept>
#include <string>

namespace vesalius {

/// An error that ends an operation: an unusable file, option or device. The message is one line and names the file, the
/// place in it and what was expected.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An invalid command line or option value (exit code 2 of the program).
class UsageError : public Error {
 public:
  using Error::Error;
};

/// A device that is not there, ran out of memory or was lost. What was asked of it may be done on another.
class DeviceError : public Error {
 public:
  using Error::Error;
};

/// Runs `f` and adds the prefix "context: " to the message of any Error that it throws.
template <class F>
auto with_context(const std::string& context, F&& f) -> decltype(f()) {
  try {
    return f();
  } catch (const UsageError& e) {
    throw UsageError(context + ": " + e.what());
  } catch (const DeviceError& e) {
    throw DeviceError(context + ": " + e.what());
  } catch (const Error& e) {
    throw Error(context + ": " + e.what());
  }
}

}  // namespace vesalius
