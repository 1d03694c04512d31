#pragma once

#include <map>
#include <mutex>
#include <optional>

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Where finished trees of a training are kept, so that a run that was cut short goes on. All members may be called
/// from several threads at once.
class TreeStore {
 public:
  virtual ~TreeStore() = default;
  /// Returns a tree that was saved; none where it was not, or cannot be read any more.
  virtual std::optional<Tree> load(int number) = 0;
  /// Throws Error where the tree cannot be kept.
  virtual void save(int number, const Tree& tree) = 0;
};

/// Keeps trees as long as it lives.
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
