#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "downloads/sha256.h"
#include "io/files/descriptor.h"
#include "vesalius/error.h"

namespace vesalius {

/// This error says that bytes are not the expected ones: there are too many or too few, or the digest differs.
class WrongBytes : public Error {
 public:
  using Error::Error;
};

/// The size and digest that a file must have.
struct FileDigest {
  std::uint64_t bytes = 0;
  std::string sha256;  ///< 64 lower-case hexadecimal digits
};

/// Returns whether `path` is a regular file of this size and SHA-256. Throws Error if it cannot be read.
bool holds(const std::string& path, const FileDigest& expected);

/// A file that gets its final name only if its size and SHA-256 are right. Until then its bytes have another name on
/// the same file system; the destructor removes them.
class VerifiedFile {
 public:
  /// Creates the file under its unfinished name and replaces a file that has that name. Throws Error with the path and
  /// the system's reason if it cannot.
  VerifiedFile(std::string path, std::string unfinished_path, FileDigest expected);
  ~VerifiedFile();
  VerifiedFile(const VerifiedFile&) = delete;
  VerifiedFile& operator=(const VerifiedFile&) = delete;

  /// Appends bytes. Throws WrongBytes before writing if there are more than expected, and Error if the disk does not
  /// take them.
  void write(std::string_view bytes);
  /// Removes what was written, to begin again.
  void restart();
  /// Creates missing folders and gives the file its name. Throws WrongBytes if the size or digest differs, and Error if
  /// the file system refuses.
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
