#pragma once

#include <string>
#include <string_view>

#include "io/files/descriptor.h"

namespace vesalius {

/// Returns whether `path` is a device, a pipe or /dev/stdout (a link to whatever the shell opened): these must keep
/// being what they are.
bool written_directly(const std::string& path);

/// A file being written beside its final place: `commit` renames it there, the destructor removes what was not
/// committed. What killed processes left of a file of this name is removed first. For writers that need a path of their
/// own; others use `write_file_atomically`.
class TemporaryFile {
 public:
  /// Makes an empty file. Its name is the final one, ".tmp", a number unique on this machine, and `extension`. Throws
  /// Error naming the final path where it cannot.
  explicit TemporaryFile(std::string final_path, const std::string& extension = "");
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& final_path() const { return final_path_; }
  /// Open for writing, and locked as long as this lives.
  const Descriptor& descriptor() const { return descriptor_; }
  /// Throws Error naming the final path when it cannot be closed or renamed.
  void commit();

 private:
  std::string final_path_;
  std::string path_;
  Descriptor descriptor_;
  bool committed_ = false;
};

/// Writes `bytes` so that a reader sees the old file or the whole new one; what is no regular file (a pipe, a device)
/// is written directly. Throws Error with the path and the system's reason, leaving no temporary file.
void write_file_atomically(const std::string& path, std::string_view bytes);

}  // namespace vesalius
