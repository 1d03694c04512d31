#pragma once

#include <map>
#include <mutex>
#include <optional>

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Keeps the finished trees of a training, so that an interrupted run can be continued. All members may be called from
/// several threads at once.
class TreeStore {
 public:
  virtual ~TreeStore() = default;
  /// Returns a saved tree, or nothing if it was not saved or cannot be read any more.
  virtual std::optional<Tree> load(int number) = 0;
  /// Saves a tree. Throws Error if it cannot.
  virtual void save(int number, const Tree& tree) = 0;
};

/// Keeps trees in memory.
class MemoryTreeStore : public TreeStore {
 public:
  std::optional<Tree> load(int number) override {
    const std::scoped_lock lock(mutex_);
    const auto found = trees_.find(number);
    return found != trees_.end() ? std::optional(found->second) : std::nullopt;
  }
  void save(int number, const Tree& tree) override {
    const std::scoped_lock lock(mutex_);
    trees_[number] = tree;
  }

 private:
  std::mutex mutex_;
  std::map<int, Tree> trees_;
};

}  // namespace vesalius
