#pragma once

#include "cluster/store.h"

namespace vesalius {

/// A folder that all machines see under the same path.
class FolderStore : public Store {
 public:
  /// The folder need not exist: write() makes it. Throws UsageError if `folder` is empty.
  explicit FolderStore(const std::string& folder);

  /// The folder's absolute path, since others may run elsewhere.
  std::string place() const override { return folder_; }
  std::string read(const std::string& name) const override;
  HugeBuffer load(const std::string& name) const override;
  bool exists(const std::string& name) const override;
  void write(const std::string& name, const std::string& bytes) override;
  std::vector<std::string> list(const std::string& folder) const override;
  void remove(const std::string& name) override;

 private:
  std::string path_of(const std::string& name) const;

  std::string folder_;
};

}  // namespace vesalius
