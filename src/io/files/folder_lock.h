#pragma once

#include <string>

namespace vesalius {

/// A folder that one process at a time writes. Gone with the process, however it ends.
class FolderLock {
 public:
  /// Makes the folder where there is none. Throws Error naming it where it cannot be made or read, and while another
  /// process has it.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace vesalius
