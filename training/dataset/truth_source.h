#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metrics/frame_truth.h"

namespace vesalius {

/// A sequence of frames with their truth.
class TruthSource {
 public:
  virtual ~TruthSource() = default;
  /// Returns the next frame, or nothing at the end. Throws Error if the frame cannot be read; the next call then
  /// continues after it.
  virtual std::optional<TrueFrame> next() = 0;
  /// Says that no more frames are wanted of the recording (FrameTruth::sequence) that the last one belongs to. A source
  /// may leave those out where that is quicker than to read them, and may as well give them.
  virtual void leave_sequence() {}
  /// Returns the total number of frames, or -1 if it is not known.
  virtual int size() const = 0;
  /// Returns remarks for the user, one line each.
  virtual std::vector<std::string> notes() const { return {}; }
  /// Returns the names of the parts; labels are indices into them. The list is empty if there are no labels.
  virtual std::vector<std::string> part_names() const { return {}; }
};

}  // namespace vesalius
