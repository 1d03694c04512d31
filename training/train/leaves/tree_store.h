#pragma once

#include <map>
#include <mutex>
#include <optional>

#include "train/messages/leaf_messages.h"
#include "vesalius/forest.h"

namespace vesalius {

/// Where the learning of leaves is.
struct LeafState {
  int rounds = 0;  ///< done
  LeafLogits logits;

  static void visit_fields(auto&& visit, auto&... of) { visit("rounds", of.rounds...)("logits", of.logits...); }
};

/// Keeps the finished trees of a training, and the leaves in learning, so that an interrupted run can be continued. The
/// members about trees may be called from several threads at once.
class TreeStore {
 public:
  virtual ~TreeStore() = default;
  /// Returns a saved tree, or nothing if it was not saved or cannot be read any more.
  virtual std::optional<Tree> load(int number) = 0;
  /// Saves a tree. Throws Error if it cannot.
  virtual void save(int number, const Tree& tree) = 0;
  /// Returns what was saved last, or nothing if nothing was or it cannot be read any more.
  virtual std::optional<LeafState> load_leaves() = 0;
  /// Replaces what was saved before. Throws Error if it cannot.
  virtual void save_leaves(const LeafState& state) = 0;
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
  std::optional<LeafState> load_leaves() override { return leaves_; }
  void save_leaves(const LeafState& state) override { leaves_ = state; }

 private:
  std::mutex mutex_;
  std::map<int, Tree> trees_;
  std::optional<LeafState> leaves_;
};

}  // namespace vesalius
