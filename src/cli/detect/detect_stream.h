#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <vector>

#include "io/sources/open_source.h"
#include "vesalius/base/stage_times.h"
#include "vesalius/detect.h"

namespace vesalius::cli {

/// A frame and what was found in it, or why there is nothing.
struct FoundFrame {
  std::optional<Frame> frame;  ///< none where it could not be read
  std::vector<Person> people;
  StageTimes times;
  double read_ms = 0.0;
  std::exception_ptr error;  ///< of reading or detecting
};

struct StreamOptions {
  bool realtime = false;  ///< frames come when they were taken; those that find the detector busy are dropped
  double rate = 30.0;     ///< frames per second of a source without times
};

/// Reads frames, finds people and hands all of it to `take`, in the caller's thread and in the source's order, until
/// the source ends, `take` returns false or an interrupt comes. With more than one thread allowed reading goes ahead,
/// and two frames are worked on at a time (in real time one). Passes on what `take` throws. Returns how many frames
/// were dropped.
int stream_frames(FrameSource& source, const Detector& detector, const StreamOptions& options,
                  const std::function<bool(FoundFrame)>& take);

}  // namespace vesalius::cli
