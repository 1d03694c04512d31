#pragma once

#include <mutex>
#include <utility>
#include <vector>

namespace vesalius {

/// Values whose memory is worth keeping, handed from one user to the next: new pages cost as much as a small stage of
/// the detector. Safe to use from several threads at once.
template <class T>
class Pool {
 public:
  /// Returns a value that somebody gave back, in whatever state, or a new one.
  T take() {
    const std::scoped_lock lock(mutex_);
    if (free_.empty()) return T{};
    T value = std::move(free_.back());
    free_.pop_back();
    return value;
  }
  void give_back(T value) {
    const std::scoped_lock lock(mutex_);
    free_.push_back(std::move(value));
  }

 private:
  std::mutex mutex_;
  std::vector<T> free_;
};

}  // namespace vesalius
