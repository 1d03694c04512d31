#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/appearance.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/options.h"
#include "vesalius/detection.h"
#include "vesalius/planes/find_planes.h"
#include "vesalius/track/smooth_joints.h"
#include "vesalius/track/tracked_frame.h"

namespace vesalius {

class BodyFitter;

struct TrackOptions {
  float rate = 30.F;       ///< frames a second of sources without times
  int confirm = 3;         ///< frames in which somebody must be found to be more than a guess ...
  float confirm_s = 1.F;   ///< ... with at most this much time from one to the next
  float hidden_s = 3.F;    ///< time after which somebody who is not found is lost
  float down_s = 30.F;     ///< the same of somebody near the floor, as long as something is there
  float gap_s = 5.F;       ///< a longer step in time, or one backwards, loses everybody
  int remembered = 32;     ///< most lost people who are known again
  float same_look = 0.1F;  ///< most difference of looks (look_distance) of one person who comes back
  float odds = 40.F;       ///< most by which having been found before multiplies the odds of being found again
  bool smooth = true;      ///< whether TrackedPerson::smoothed is filled
  JointSmoothing smoothing;
};
void visit_options(const std::string& prefix, TrackOptions& options, OptionVisitor& visitor);

/// Follows people over the frames of one source. Everything is in the optical frame; a camera that moves evenly only
/// adds to the people's own motion. The people of a frame may come in any order. How fast frames are worked at does not
/// matter, only their times.
class PeopleTracker {
 public:
  /// `body` is that of the people, such as Detector::body, and must outlive this object. `appearance` is the
  /// detector's; without one looks do not matter. Without `fitter` nobody has a fitted body. Throws UsageError for an
  /// option outside its range.
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

  /// Returns what the frames before tell about the people of this one, which comes next.
  Prior expect(const Frame& frame) const;

  /// Takes what was found in the next frame: its people, and its planes. People whose masks have another size than the
  /// frame have no mask. Throws Error for people of another body.
  TrackedFrame update(const Frame& frame, std::vector<Person> people, const std::vector<Plane>& planes = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius
