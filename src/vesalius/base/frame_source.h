#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vesalius/base/frame.h"

namespace vesalius {

/// A stream of frames: a folder, a file, a sensor.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Returns the next frame, or nothing at the end. Throws Error for a frame that cannot be read; the next call passes
  /// over it.
  virtual std::optional<Frame> next() = 0;
  /// Returns the number of frames in all, -1 where it is not known.
  virtual int size() const = 0;
  /// Returns what a user should know, one line each: guessed intrinsics, depth pictures without colour.
  virtual std::vector<std::string> notes() const { return {}; }
};

}  // namespace vesalius
