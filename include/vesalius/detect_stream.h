#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <optional>

#include "vesalius/detect.h"
#include "vesalius/frame_source.h"
#include "vesalius/stage_times.h"
#include "vesalius/track_people.h"

namespace vesalius {

/// A frame with the people in it, or the error that prevented it.
struct FoundFrame {
  std::optional<Frame> frame;  ///< empty if it could not be read
  TrackedFrame people;         ///< followed over frames, where that was asked for
  StageTimes times;
  double read_ms = 0.0;
  double track_ms = 0.0;  ///< time to follow people, beside the detector's stages and without waiting for other frames
  /// From the frame's arrival (Frame::arrived_s) to its people; none where it has no arrival.
  std::optional<double> latency_ms;
  std::exception_ptr error;  ///< exception of reading or detecting; null if there was none
};

struct StreamOptions {
  /// In real time, frames come at the pace at which they were taken and are dropped while the detector is busy. A live
  /// source always does that.
  bool realtime = false;
  double rate = kUsualRate;  ///< frames per second in real time, for a source without times
  /// This function is asked at least every 50 ms, in the caller's thread, whether to end; empty means never.
  std::function<bool()> stop;
};

/// Reads frames, finds people and passes both to `take`, in the caller's thread and in the source's order, until the
/// source ends, `take` returns false or `stop` returns true. If more than one thread is allowed (ThreadLimit), frames
/// are read ahead and two are processed at a time (in real time one). The people are the same for any number of
/// threads. Exceptions of `take` are passed on. A live source is stopped at the end. Returns the number of dropped
/// frames.
///
///   Detector detector(load_model("default.model"));
///   const auto source = open_source("frames/");
///   stream_frames(*source, detector, {}, [&](FoundFrame found) {
///     if (found.error) std::rethrow_exception(found.error);
///     std::cout << frame_json(*found.frame, found.people, detector.body()) << '\n';
///     return true;
///   });
int stream_frames(FrameSource& source, const Detector& detector, const StreamOptions& options,
                  const std::function<bool(FoundFrame)>& take);

/// As above, and follows the people over the frames: what `tracker` knows of them helps to find them, and
/// FoundFrame::people has them with their ids. The tracker is asked and told frame by frame in the source's order;
/// where every frame is looked at as a whole (TrackOptions::whole_s is 0), the pixels of the next are labelled
/// meanwhile. A frame that fails leaves the tracker as it is. Ids are the same for any number of threads and any speed,
/// but in real time, where frames are dropped. `tracker` must follow people of the detector's body and is used until
/// this function returns.
int stream_frames(FrameSource& source, const Detector& detector, PeopleTracker& tracker, const StreamOptions& options,
                  const std::function<bool(FoundFrame)>& take);

/// As above, without looking for people: for whoever passes frames on, such as to a disk. Frames are read in a thread
/// of their own, and up to `ahead` of them wait for `take`. Those of a live source that find no room are dropped; other
/// sources wait. Of StreamOptions only `stop` counts.
int stream_frames(FrameSource& source, const StreamOptions& options, std::size_t ahead,
                  const std::function<bool(FoundFrame)>& take);

}  // namespace vesalius
