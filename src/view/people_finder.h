#pragma once

#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/recordings/frame_recorder.h"
#include "stream/merged_cameras.h"
#include "vesalius/body_model.h"
#include "vesalius/track_people.h"
#include "view/frame_message.h"
#include "view/player.h"

namespace vesalius {

/// A tracker for a source in which one moves. Each frame goes on from what was known at the newest frame before it, so
/// that whoever steps back, or looks at a frame once more, sees the same people under the same ids. Further back than
/// the last frames (two seconds of 30 a second) it is a jump in time: everybody is lost, looks are kept, and ids go on
/// counting.
class TrackHistory {
 public:
  explicit TrackHistory(PeopleTracker first);

  /// Returns what was known before the frame of this time; the caller lets it go on with that frame. Nothing is kept of
  /// later ones. The reference holds until the next call.
  PeopleTracker& before(double at_s);

  /// Begins anew with other options, looks and fitter; ids go on counting. Throws UsageError for an option outside its
  /// range.
  void restart(const TrackOptions& options, const std::shared_ptr<const Appearance>& appearance,
               const std::shared_ptr<const BodyFitter>& fitter);

 private:
  struct Known {
    double at_s;  ///< place of the frame that was added last
    PeopleTracker tracker;
  };

  std::deque<Known> known_;  ///< in order of time; never empty
};

/// Options, and the detector that has them.
struct FinderSettings {
  PeopleOptions options;
  Detector detector;
};

/// Finds the people in frames of a source in which one moves, and follows them if that is wanted.
class PeopleFinder {
 public:
  using Settings = std::shared_ptr<const FinderSettings>;

  /// Throws UsageError for an option outside its range.
  PeopleFinder(Settings settings, bool track, MergePeople merge = {});

  /// Returns a frame's people, with all that the page shows of them but the latency. If `settings` are not those of the
  /// frame before, people are followed anew where they have to be. With a trace if `with_stages`. Throws what the
  /// detector and the tracker throw.
  ViewedFrame find(const std::shared_ptr<const PlayedFrame>& played, const Settings& settings, bool with_stages);

  /// Follows people anew, under ids that nobody had: what comes next is of another source.
  void begin_anew();

 private:
  void take_over(const Settings& settings);
  void follow(ViewedFrame& viewed);

  Settings settings_;
  std::optional<TrackHistory> tracks_;  ///< none if people are not followed
  MergePeople merge_;                   ///< empty for one camera
  int frames_ = 0;
};

/// A recording of what a viewer shows. All throws Error naming the path if it cannot be written.
class PageRecording {
 public:
  /// Creates a new file in `folder`. Frames without times get those of `rate` frames a second.
  PageRecording(const std::string& folder, double rate);

  /// Adds a frame with its people unless its time is there already: a recording shows a source once, however it was
  /// moved in.
  void add_frame(const ViewedFrame& viewed, const BodyModel& body);
  /// Completes the file.
  void close() { file_.close(); }

  const std::string& path() const { return path_; }
  int frames() const { return frames_; }

 private:
  std::string path_;
  FrameRecorder file_;
  double rate_;
  int frames_ = 0;
  double up_to_s_ = -std::numeric_limits<double>::infinity();
};

}  // namespace vesalius
