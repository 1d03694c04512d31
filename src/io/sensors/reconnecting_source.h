#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "vesalius/frame_source.h"

namespace vesalius {

/// How to bridge the time in which a camera is away.
struct ReconnectOptions {
  std::string place;  ///< the camera's name in the line that says that it is back
  /// Gets one line when the camera is lost and one when it is back, in the thread that calls `next`; may be empty.
  std::function<void(const std::string&)> say;
  std::chrono::milliseconds retry{1000};  ///< between attempts to open it again
};

/// Opens a camera by `open` and returns its frames. Where it fails, which an Error says, it is opened again and again
/// until it is back; `stop` ends the waiting. Times go on from where they were: the first frame that comes back is as
/// much later than the last one before as it arrived later, whatever the camera's clock says, and those that follow
/// keep their distance to it, or that of their arrivals where its clock stands. Frames of the time between are not
/// counted as missed. Throws Error if the camera cannot be opened the first time: it would rather be named wrongly.
std::unique_ptr<FrameSource> keep_open(std::function<std::unique_ptr<FrameSource>()> open, ReconnectOptions options);

}  // namespace vesalius
