#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace vesalius::cli {

/// Hands things from thread to thread in order, at most `capacity` of them waiting.
template <class T>
class FrameQueue {
 public:
  explicit FrameQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Waits for room. False where the queue is closed, and `item` is gone.
  bool push(T item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || items_.size() < capacity_; });
    if (closed_) return false;
    items_.push_back(std::move(item));
    changed_.notify_all();
    return true;
  }

  /// Never waits: where there is no room the oldest makes it. How many were given up, 0 or 1.
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

  /// Waits for the next one: none when the queue is closed and empty, or after `patience`.
  std::optional<T> pop(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, patience, [&] { return closed_ || !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    changed_.notify_all();
    return item;
  }

  /// No more come; what waits can still be taken.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

  /// Waits until `time`, or until the queue is closed, which it tells.
  bool closed_by(std::chrono::steady_clock::time_point time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_until(lock, time, [&] { return closed_; });
  }

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

}  // namespace vesalius::cli
