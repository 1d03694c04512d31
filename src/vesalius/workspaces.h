#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "vesalius/forest/label_pixels.h"

namespace vesalius {

/// Large memory of frames past, which the next ones use again: new pages cost as much as a small stage.
class Workspaces {
 public:
  struct Workspace {
    Posteriors raw;     ///< pass 1
    Posteriors smooth;  ///< pass 1, unless labels are smoothed
  };

  std::unique_ptr<Workspace> take() {
    const std::scoped_lock lock(mutex_);
    if (free_.empty()) return std::make_unique<Workspace>();
    std::unique_ptr<Workspace> workspace = std::move(free_.back());
    free_.pop_back();
    return workspace;
  }
  void give_back(std::unique_ptr<Workspace> workspace) {
    const std::scoped_lock lock(mutex_);
    free_.push_back(std::move(workspace));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Workspace>> free_;
};

}  // namespace vesalius
