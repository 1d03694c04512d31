#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "vesalius/frame_source.h"

namespace vesalius {

/// Frames that another thread hands over, as a source.
class PulledFrames final : public FrameSource {
 public:
  /// `pull` waits for a frame, and returns nothing at the end.
  explicit PulledFrames(std::function<std::optional<Frame>()> pull) : pull_(std::move(pull)) {}
  std::optional<Frame> next() override { return pull_(); }
  int size() const override { return -1; }

 private:
  std::function<std::optional<Frame>()> pull_;
};

}  // namespace vesalius
