#pragma once

#include <string>

#include "io/files/descriptor.h"

namespace vesalius {

/// Lets only one process at a time write to a folder. The lock ends with the process, however that ends.
class FolderLock {
 public:
  /// Creates the folder if it does not exist. Throws Error naming it if it cannot be created or read, or if another
  /// process holds the lock.
  explicit FolderLock(const std::string& folder);

 private:
  Descriptor descriptor_;
};

/// A folder of this process in the system's place for temporary files. The destructor removes it with all in it.
class TemporaryFolder {
 public:
  /// Throws Error if it cannot be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /// Returns the path of a file in it.
  std::string path(const std::string& name) const { return folder_ + "/" + name; }

 private:
  std::string folder_;
};

}  // namespace vesalius
