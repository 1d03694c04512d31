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
  /// Closes it now. Returns the error number, 0 where there is none: some file systems say only here that the disk is
  /// full.
  int close();

 private:
  int fd_;
};

/// A regular file that is open for reading.
struct OpenFile {
  Descriptor descriptor;
  std::uint64_t size = 0;  ///< bytes
};

/// Throws Error naming `path` where there is none, it cannot be read, or is no regular file (a pipe would block).
OpenFile open_regular_file(const std::string& path);

/// Writes all bytes. Returns the error number of what failed, 0 where nothing did.
int write_all(const Descriptor& descriptor, std::string_view bytes);

}  // namespace vesalius
