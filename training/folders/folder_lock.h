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

}  // namespace vesalius
