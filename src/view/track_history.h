#pragma once

#include <deque>
#include <memory>

#include "vesalius/track_people.h"

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

}  // namespace vesalius
