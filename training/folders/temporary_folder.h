#pragma once

#include <string>

namespace vesalius {

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
