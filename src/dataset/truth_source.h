#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vesalius/base/frame_truth.h"

namespace vesalius {

/// Frames with their truth, one after the other.
class TruthSource {
 public:
  virtual ~TruthSource() = default;
  /// Returns the next frame, or nothing at the end. Throws Error for one that cannot be read; the next call passes over
  /// it.
  virtual std::optional<TrueFrame> next() = 0;
  /// Returns the number of frames in all, -1 where it is not known.
  virtual int size() const = 0;
  /// Returns what a user should know, one line each.
  virtual std::vector<std::string> notes() const { return {}; }
  /// Returns the names of the parts that labels are numbers of; none where there are no labels.
  virtual std::vector<std::string> part_names() const { return {}; }
};

}  // namespace vesalius
