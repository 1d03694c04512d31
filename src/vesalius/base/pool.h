#pragma once

#include <mutex>
#include <utility>
#include <vector>

namespace vesalius {

/// A pool of values whose memory is reused, because new pages cost as much as a small stage of the detector. It may be
/// used from several threads at once.
template <class T>
class Pool {
 public:
  /// Returns a value that was given back, in whatever state it is, or a new one.
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
