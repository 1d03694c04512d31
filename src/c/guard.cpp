#include "c/guard.h"

#include <array>
#include <exception>
#include <new>
#include <string_view>

namespace vesalius::c {
namespace {

/// Memory that is there when there is no other.
thread_local std::array<char, 1024> last_message{};

/// Keeps as much as there is room for.
vesalius_status keep(vesalius_status status, std::string_view message) noexcept {
  std::size_t length = 0;
  for (const char c : message.substr(0, last_message.size() - 1)) {
    last_message[length++] = static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  // No character of UTF-8 is cut in two.
  if (length < message.size()) {
    while (length > 0 && (static_cast<unsigned char>(message[length]) & 0xC0U) == 0x80U) --length;
  }
  last_message[length] = '\0';
  return status;
}

}  // namespace

vesalius_status keep_exception() noexcept {
  try {
    throw;
  } catch (const CapacityError& e) {
    return keep(VESALIUS_ERROR_CAPACITY, e.what());
  } catch (const UsageError& e) {
    return keep(VESALIUS_ERROR_ARGUMENT, e.what());
  } catch (const DeviceError& e) {
    return keep(VESALIUS_ERROR_DEVICE, e.what());
  } catch (const Error& e) {
    return keep(VESALIUS_ERROR_INPUT, e.what());
  } catch (const std::bad_alloc&) {
    return keep(VESALIUS_ERROR_MEMORY, "out of memory");
  } catch (const std::exception& e) {
    return keep(VESALIUS_ERROR_INTERNAL, e.what());
  } catch (...) {
    return keep(VESALIUS_ERROR_INTERNAL, "an exception of unknown kind");
  }
}

const char* last_error() noexcept { return last_message.data(); }

}  // namespace vesalius::c
