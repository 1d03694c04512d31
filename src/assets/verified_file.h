#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "assets/sha256.h"
#include "io/files/descriptor.h"
#include "vesalius/base/error.h"

namespace vesalius {

/// Is thrown for bytes that are not the ones asked for: too many, too few, or others.
class WrongBytes : public Error {
 public:
  using Error::Error;
};

/// What a file must be.
struct FileDigest {
  std::uint64_t bytes = 0;
  std::string sha256;  ///< 64 small hexadecimal digits
};

/// Returns whether a regular file of this size and SHA-256 is there. Throws Error where it cannot be read.
bool holds(const std::string& path, const FileDigest& expected);

/// A file that gets its final name only once size and SHA-256 are right. Until then its bytes lie under another name of
/// the same file system, which the destructor removes.
class VerifiedFile {
 public:
  /// Throws Error with the path and the system's reason where it cannot be made. A file under the other name is
  /// replaced.
  VerifiedFile(std::string path, std::string unfinished_path, FileDigest expected);
  ~VerifiedFile();
  VerifiedFile(const VerifiedFile&) = delete;
  VerifiedFile& operator=(const VerifiedFile&) = delete;

  /// Throws WrongBytes, before writing, once there are more than expected; Error where the disk takes no more.
  void write(std::string_view bytes);
  /// Removes what was written, so that the file begins anew.
  void restart();
  /// Makes the folders on the way and gives the file its name. Throws WrongBytes where size or sum differ, Error where
  /// it cannot.
  void commit();

  const std::string& path() const { return path_; }
  std::uint64_t written() const { return written_; }

 private:
  [[noreturn]] void fail(int error) const;

  std::string path_;
  std::string unfinished_path_;
  FileDigest expected_;
  Sha256 sum_;
  std::uint64_t written_ = 0;
  Descriptor file_;
  bool committed_ = false;
};

}  // namespace vesalius
