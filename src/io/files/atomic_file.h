#pragma once

#include <string>
#include <string_view>

#include "io/files/descriptor.h"

namespace vesalius {

/// Returns whether `path` is a device, a pipe or /dev/stdout. Such a path is written directly, because replacing it by
/// a regular file would break it.
bool written_directly(const std::string& path);

/// A temporary file beside the place where it will stay. `commit` renames it to its final name; the destructor removes
/// it if it was not committed. The constructor also removes temporary files of the same name that killed processes left
/// behind. This class is for writers that need a path of their own; others use `write_file_atomically`.
class TemporaryFile {
 public:
  /// Creates an empty file. Its name is the final name, then ".tmp", a number unique on this machine, and `extension`.
  /// Throws Error naming the final path if the file cannot be created.
  explicit TemporaryFile(std::string final_path, const std::string& extension = "");
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& final_path() const { return final_path_; }
  /// The file, open for writing. It stays locked as long as this object lives.
  const Descriptor& descriptor() const { return descriptor_; }
  /// Gives the file its final name. Throws Error naming the final path if closing or renaming fails.
  void commit();

 private:
  std::string final_path_;
  std::string path_;
  Descriptor descriptor_;
  bool committed_ = false;
};

/// Writes a file in one step: a reader sees either the old content or all of `bytes`. A pipe or a device is written
/// directly. Throws Error with the path and the system's reason; no temporary file is left behind.
void write_file_atomically(const std::string& path, std::string_view bytes);

/// Throws the Error of write_file_atomically if the file cannot be written, and leaves nothing behind: for work that
/// takes long before there is something to write.
void check_writable(const std::string& path);

}  // namespace vesalius
