#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/detect.h"
#include "vesalius/frame.h"
#include "vesalius/people_options.h"
#include "vesalius/person.h"

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

  /// Takes what was found in the next frame: its people, and its planes. People whose masks have another size than the
  /// frame have no mask. Throws Error for people of another body.
  TrackedFrame update(const Frame& frame, std::vector<Person> people, const std::vector<Plane>& planes = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns a tracker of the people whom the detector finds, with a body fitted to each. Throws UsageError for an option
/// outside its range.
PeopleTracker make_tracker(const Detector& detector, const PeopleOptions& options);

/// Finds the people of the frame that comes next, and follows them.
TrackedFrame follow(const Detector& detector, PeopleTracker& tracker, const Frame& frame);

}  // namespace vesalius
