#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace vesalius {

/// A file descriptor that is closed with this object.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() { close(); }

  int get() const { return fd_; }
  bool is_open() const { return fd_ >= 0; }
  /// Closes the descriptor now. Returns the error number, or 0 if there was no error. Some file systems report a full
  /// disk only at this point.
  int close();

 private:
  int fd_;
};

/// A regular file that is open for reading.
struct OpenFile {
  Descriptor descriptor;
  std::uint64_t size = 0;  ///< bytes
};

/// Opens a regular file. Throws Error naming `path` if it does not exist, cannot be read, or is not a regular file
/// (opening a pipe would block).
OpenFile open_regular_file(const std::string& path);

/// Writes all bytes. Returns the error number of the first failure, or 0.
int write_all(const Descriptor& descriptor, std::string_view bytes);

}  // namespace vesalius
