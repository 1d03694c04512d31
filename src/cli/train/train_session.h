#pragma once

#include <optional>
#include <string>

#include "io/files/folder_lock.h"
#include "train/tree_store.h"
#include "vesalius/forest/forest.h"

namespace vesalius::cli {

/// Keeps the trees of a forest that is being trained, each in a file of its own, so that a run that was cut short goes
/// on. One process at a time.
class TrainSession : public TreeStore {
 public:
  /// Makes `folder`, or goes on with what an earlier run with the same recipe left there. With `restart`, what it left
  /// is removed first. `forest` is the one being trained, with its recipe and without trees. Throws Error naming the
  /// folder where it has other files in it, belongs to another recipe (naming the first difference), cannot be made, or
  /// another process works there.
  TrainSession(const std::string& folder, Forest forest, bool restart);

  /// Returns a tree that was saved; none where it was not, or its file is damaged.
  std::optional<Tree> load(int number) override;
  /// Writes a model of that one tree, whose file appears whole or not at all. Throws Error when it cannot be written.
  void save(int number, const Tree& tree) override;
  /// Removes the trees and the folder; the session is over.
  void remove();

  const std::string& folder() const { return folder_; }

 private:
  std::string path(int number) const;
  void tidy(bool all) const;

  std::string folder_;
  Forest forest_;  ///< without trees
  std::optional<FolderLock> lock_;
};

}  // namespace vesalius::cli
