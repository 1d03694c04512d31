#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <vector>

#include "vesalius/base/frame_source.h"
#include "vesalius/base/stage_times.h"
#include "vesalius/detect.h"

namespace vesalius {

/// A frame and what was found in it, or why there is nothing.
struct FoundFrame {
  std::optional<Frame> frame;  ///< none where it could not be read
  std::vector<Person> people;
  StageTimes times;
  double read_ms = 0.0;
  std::exception_ptr error;  ///< what reading or detecting threw; null where both went well
};

struct StreamOptions {
  bool realtime = false;  ///< frames come when they were taken; those that find the detector busy are dropped
  double rate = 30.0;     ///< frames per second of a source without times, in real time
  std::function<bool()>
      stop;  ///< asked at least every 50 ms whether to end; empty: never. Called in the caller's thread
};

/// Reads frames, finds people and hands both to `take`, in the caller's thread and in the source's order, until the
/// source ends, `take` returns false or `stop` true. Where more than one thread is allowed (ThreadLimit), frames are
/// read ahead and two are worked on at a time (in real time one). The people are the same for any number of threads.
/// Passes on what `take` throws. Returns how many frames were dropped.
///
///   Detector detector(load_model("default.forest"));
///   const auto source = open_source("frames/");
///   stream_frames(*source, detector, {}, [&](FoundFrame found) {
///     if (found.error) std::rethrow_exception(found.error);
///     std::cout << frame_json(*found.frame, found.people, detector.body()) << '\n';
///     return true;
///   });
int stream_frames(FrameSource& source, const Detector& detector, const StreamOptions& options,
                  const std::function<bool(FoundFrame)>& take);

}  // namespace vesalius
