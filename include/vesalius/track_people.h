#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/detect.h"
#include "vesalius/frame.h"
#include "vesalius/people_options.h"
#include "vesalius/person.h"
#include "vesalius/stage_times.h"

namespace vesalius {

class BodyFitter;

/// Follows people over the frames of one source. Everything is in the optical frame; a camera that moves evenly only
/// adds to the people's own motion. The people of a frame may come in any order. How fast frames are worked at does not
/// matter, only their times.
class PeopleTracker {
 public:
  /// `body` is that of the people, such as Detector::body. `appearance` is the detector's; without one looks do not
  /// matter. Without `fitter` nobody has a fitted body. Throws UsageError for an option outside its range.
  explicit PeopleTracker(const BodyModel& body, TrackOptions options = {},
                         std::shared_ptr<const Appearance> appearance = nullptr,
                         std::shared_ptr<const BodyFitter> fitter = nullptr);
  ~PeopleTracker();
  /// A copy goes on by itself from what is known now.
  PeopleTracker(const PeopleTracker&);
  PeopleTracker& operator=(const PeopleTracker&);
  PeopleTracker(PeopleTracker&&) noexcept;
  PeopleTracker& operator=(PeopleTracker&&) noexcept;

  /// Returns a tracker with other options, looks and fitter that knows nobody. Its ids go on counting, so that none is
  /// used again. Throws UsageError for an option outside its range.
  PeopleTracker restarted(TrackOptions options, std::shared_ptr<const Appearance> appearance,
                          std::shared_ptr<const BodyFitter> fitter) const;

  /// Returns a tracker with the same options that knows nobody, whose ids go on counting too.
  PeopleTracker restarted() const;

  /// Returns what the frames before tell about the people of this one, which comes next.
  Prior expect(const Frame& frame) const;

  /// Returns a part of this frame, which comes next, that has all people: the box about those of the frame before, a
  /// third larger, where they have gone since. Nothing if the whole picture is to be looked at: where nobody is
  /// followed, or somebody was not found, every TrackOptions::whole_s, and where anything else has changed since then,
  /// as it does with a camera that moves. So whoever comes in is found that much later at most.
  std::optional<PictureRegion> region(const Frame& frame) const;
  /// Returns whether `region` may return one.
  bool knows_regions() const;

  /// Takes what was found in the next frame. People whose masks have another size than the frame have no mask. Throws
  /// Error for people of another body.
  TrackedFrame update(const Frame& frame, Detection found);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns a tracker of the people whom the detector finds, with a body fitted to each. Throws UsageError for an option
/// outside its range.
PeopleTracker make_tracker(const Detector& detector, const PeopleOptions& options);

/// What a caller of `follow` asks for, and is told beside the people.
struct FollowReport {
  Trace* trace = nullptr;           ///< filled if there is one; then the whole picture is looked at
  std::function<void()> wait = {};  ///< called before the tracker is asked, until all frames before this one are done
  StageTimes times = {};
  double track_ms = 0.0;           ///< time to follow people, beside the detector's stages
  std::vector<Plane> planes = {};  ///< Detection::planes
};

/// Finds the people of the frame that comes next, and follows them. Looks at a part of the picture where the tracker
/// knows one (PeopleTracker::region), and at all of it if somebody reaches out of that.
TrackedFrame follow(const Detector& detector, PeopleTracker& tracker, const Frame& frame);
TrackedFrame follow(const Detector& detector, PeopleTracker& tracker, const Frame& frame, FollowReport& report);

}  // namespace vesalius
