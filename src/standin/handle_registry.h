#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "vesalius/error.h"

namespace vesalius::standin {

/// Objects behind the handles of an interface, counted by references. A handle is a number that is never used again, so
/// that one of an object that is gone is told from all others. Any thread may call anything.
template <class Handle, class T>
class HandleRegistry {
 public:
  /// `name` is what errors call an object.
  explicit HandleRegistry(std::string name) : name_(std::move(name)) {}

  /// Returns a handle with one reference.
  Handle add(std::shared_ptr<T> object) {
    const std::scoped_lock lock(mutex_);
    last_ += kStep;
    entries_.emplace(last_, Entry{std::move(object), 1});
    return reinterpret_cast<Handle>(last_);  // NOLINT(performance-no-int-to-ptr): nobody looks behind it
  }

  /// The same for an object whose handle is its own address, where programs look at it.
  void add(Handle handle, std::shared_ptr<T> object) {
    const std::scoped_lock lock(mutex_);
    entries_.emplace(reinterpret_cast<std::uintptr_t>(handle), Entry{std::move(object), 1});
  }

  /// Throws UsageError for what is no handle, here and below.
  std::shared_ptr<T> get(Handle handle) const {
    const std::scoped_lock lock(mutex_);
    return find(*this, handle)->second.object;
  }
  void reference(Handle handle) {
    const std::scoped_lock lock(mutex_);
    ++find(*this, handle)->second.references;
  }
  /// Takes a reference away. Returns the object with the last one, else null.
  std::shared_ptr<T> release(Handle handle) {
    const std::scoped_lock lock(mutex_);
    const auto entry = find(*this, handle);
    if (--entry->second.references > 0) return nullptr;
    std::shared_ptr<T> object = std::move(entry->second.object);
    entries_.erase(entry);
    return object;
  }
  /// Takes all away.
  std::vector<std::shared_ptr<T>> clear() {
    const std::scoped_lock lock(mutex_);
    std::vector<std::shared_ptr<T>> objects;
    for (auto& [handle, entry] : entries_) objects.push_back(std::move(entry.object));
    entries_.clear();
    return objects;
  }

 private:
  struct Entry {
    std::shared_ptr<T> object;
    std::size_t references = 0;
  };
  static constexpr std::uintptr_t kStep = 16;  ///< as addresses of objects lie apart

  /// Of this object, const or not.
  template <class Self>
  static auto find(Self& self, Handle handle) {
    if (handle == nullptr) throw UsageError("the " + self.name_ + " is NULL");
    const auto entry = self.entries_.find(reinterpret_cast<std::uintptr_t>(handle));
    if (entry == self.entries_.end()) {
      throw UsageError("no " + self.name_ + " has this handle: it is gone, or never was");
    }
    return entry;
  }

  std::string name_;
  mutable std::mutex mutex_;
  std::uintptr_t last_ = 0;
  std::unordered_map<std::uintptr_t, Entry> entries_;
};

}  // namespace vesalius::standin
