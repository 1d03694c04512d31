#pragma once

#include <optional>
#include <string>

#include "folders/owned_folder.h"
#include "train/leaves/learn_leaves.h"
#include "vesalius/forest.h"

namespace vesalius::cli {

/// Keeps the trees of a forest in training, each in a file of its own, so that an interrupted run can be continued.
/// Only one process at a time can use a folder.
class TrainSession : public TreeStore {
 public:
  /// Creates `folder`, or continues with the trees of an earlier run with the same recipe. With `restart`, those trees
  /// are removed first. `forest` is the forest in training, with its recipe and without trees. Throws Error naming the
  /// folder if it has other files in it, belongs to another recipe (naming the first difference), cannot be created, or
  /// is in use by another process.
  TrainSession(std::string folder, Forest forest, bool restart);

  /// Returns a saved tree, or nothing if it was not saved or its file is damaged.
  std::optional<Tree> load(int number) override;
  /// Writes a model of one tree atomically. Throws Error if it cannot be written.
  void save(int number, const Tree& tree) override;
  std::optional<LeafState> load_leaves() override;
  /// Writes the state atomically. Throws Error if it cannot be written.
  void save_leaves(const LeafState& state) override;
  /// Removes the trees and the folder, which ends the session.
  void remove();

  const std::string& folder() const { return folder_; }

 private:
  std::string path(int number) const;
  std::string leaves_path() const;
  void tidy(bool all) const;

  std::string folder_;
  Forest forest_;  ///< without trees
  std::optional<FolderLock> lock_;
};

}  // namespace vesalius::cli
