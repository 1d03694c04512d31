#pragma once

#include <string>

#include "io/files/descriptor.h"

namespace vesalius {

/// A folder that one process at a time writes. Gone with the process, however it ends.
class FolderLock {
 public:
  /// Makes the folder where there is none. Throws Error naming it where it cannot be made or read, and while another
  /// process has it.
  explicit FolderLock(const std::string& folder);

 private:
  Descriptor descriptor_;
};

}  // namespace vesalius
