#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "io/files/descriptor.h"

namespace vesalius {

/// A regular file of any size, read wherever it is asked.
class DataFile {
 public:
  /// Throws Error naming `path` if it cannot be opened or is not a regular file.
  explicit DataFile(const std::string& path);

  /// A file that has no name of its own any more: `path` is for messages.
  DataFile(std::string path, OpenFile file) : path_(std::move(path)), has_name_(false), file_(std::move(file)) {}

  const std::string& path() const { return path_; }
  /// Returns whether others can open it by its path.
  bool has_name() const { return has_name_; }
  int descriptor() const { return file_.descriptor.get(); }
  std::uint64_t size() const { return file_.size; }
  /// Returns the `count` bytes from `at` on, or those up to the end where there are fewer. Throws Error if the system
  /// cannot read them.
  std::string read(std::uint64_t at, std::uint64_t count) const;
  /// Reads the bytes from `at` on into memory that is there, and returns their number: fewer only at the end.
  std::size_t read_into(std::uint64_t at, std::span<std::byte> memory) const;

 private:
  std::string path_;
  bool has_name_ = true;
  OpenFile file_;
};

/// Largest file, in bytes, that is read as a whole.
inline constexpr std::size_t kMaxFileBytes = std::size_t{1} << 30;

/// Returns the bytes of a regular file. Throws Error naming `path` if it does not exist, cannot be read, is not a
/// regular file (reading a pipe would block), or is larger than `max_bytes`.
std::string read_file(const std::string& path, std::size_t max_bytes = kMaxFileBytes);

}  // namespace vesalius
