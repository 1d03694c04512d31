#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "downloads/sha256.h"
#include "downloads/web_connection.h"
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

/// A place from which files are fetched: a folder, or an address that begins with http://, https:// or file://.
class Origin {
 public:
  /// Throws UsageError for any other kind of address and for a folder that does not exist.
  explicit Origin(const std::string& place, WebOptions options = {});

  /// Writes the file `path` of this place to `file` and returns true; returns false if there is no such file.
  /// stays_inside(path) must hold, and the caller has to commit `file`. Throws Error with the address if the file
  /// cannot be fetched, and passes on what `file` throws.
  bool get(const std::string& path, VerifiedFile& file);

  /// Returns the place of `path` for messages; a password in the address is left out.
  std::string place_of(const std::string& path) const;

 private:
  bool ask(const std::string& path, VerifiedFile& file);
  bool copy(const std::string& path, VerifiedFile& file) const;

  std::string place_;  ///< folder, or address as shown
  WebOptions options_;
  std::string address_;                        ///< empty for a folder
  std::unique_ptr<WebConnection> connection_;  ///< null for a folder; kept for the next file
};

}  // namespace vesalius
