#pragma once

#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/detect.h"

namespace vesalius {

/// Looks whether people are found in turned pictures, where none are found in the first ones as they are and nothing
/// says how the camera stands: it may lie on its side.
class TurnHint {
 public:
  explicit TurnHint(Detector detector) : detector_(std::move(detector)) {}

  /// Takes note of the next frame, in which `somebody` was found or nobody. After 30 frames without anybody, five of
  /// them are looked at in a thread of its own. Returns what to tell the user as soon as it is known, once.
  std::optional<std::string> add(const Frame& frame, bool somebody);
  /// As above, where no more frames come: looks at those that came, and waits.
  std::optional<std::string> finish();

 private:
  Detector detector_;
  bool done_ = false;
  int frames_ = 0;
  std::vector<Frame> kept_;
  std::future<std::optional<std::string>> looking_;
};

}  // namespace vesalius
