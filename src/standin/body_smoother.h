#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "vesalius/person.h"
#include "vesalius/track/track_motion.h"

namespace vesalius::standin {

/// Smooths the joints of everybody over the frames of one tracker.
class BodySmoother {
 public:
  /// Returns the person's joints of a set, smoothed by `factor`: 0 not at all, 1 most. `time_s` is the frame's.
  std::vector<Joint> smooth(const TrackedPerson& person, std::size_t set, double time_s, float factor);
  /// Forgets whom the frame does not have.
  void keep(const TrackedFrame& frame);

 private:
  struct Followed {
    JointSmoother smoother;
    double time_s = 0.0;
  };
  std::map<int, Followed> followed_;  ///< by id
};

/// Returns what makes the joints of a factor smooth. At a half it is nearly the tracker's own (docs/tracking.md), at 1
/// changes of a joint at rest pass below .2 Hz.
JointSmoothing smoothing_of(float factor);

}  // namespace vesalius::standin
