#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace vesalius {

/// Passes items from one thread to another in order. At most `capacity` items wait in it.
template <class T>
class FrameQueue {
 public:
  explicit FrameQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Waits for room, then adds the item. Returns false if the queue is closed; the item is then lost.
  bool push(T item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || items_.size() < capacity_; });
    if (closed_) return false;
    items_.push_back(std::move(item));
    changed_.notify_all();
    return true;
  }

  /// Adds the item if there is room, without waiting. Returns whether it did; otherwise the item is lost.
  bool try_push(T item) {
    const std::scoped_lock lock(mutex_);
    if (closed_ || items_.size() >= capacity_) return false;
    items_.push_back(std::move(item));
    changed_.notify_all();
    return true;
  }

  /// Adds the item without waiting. If there is no room, the oldest item is dropped. Returns the number of dropped
  /// items, 0 or 1.
  int push_newest(T item) {
    const std::scoped_lock lock(mutex_);
    int dropped = 0;
    if (!closed_ && items_.size() == capacity_) {
      items_.pop_front();
      dropped = 1;
    }
    if (!closed_) items_.push_back(std::move(item));
    changed_.notify_all();
    return dropped;
  }

  /// Waits for the next item and removes it from the queue. Returns nothing if the queue is closed and empty, or after
  /// `patience`.
  std::optional<T> pop(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, patience, [&] { return closed_ || !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    changed_.notify_all();
    return item;
  }

  /// Closes the queue to new items. Items in it can still be taken.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

  /// Waits until `time` or until the queue is closed. Returns whether it is closed.
  bool closed_by(std::chrono::steady_clock::time_point time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_until(lock, time, [&] { return closed_; });
  }

  /// Returns whether the queue is closed and empty.
  bool finished() const {
    const std::scoped_lock lock(mutex_);
    return closed_ && items_.empty();
  }

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> items_;
  bool closed_ = false;
};

}  // namespace vesalius
