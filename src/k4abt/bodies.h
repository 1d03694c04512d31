#pragma once

#include <k4abttypes.h>

#include <map>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/person.h"
#include "vesalius/track/track_motion.h"

namespace vesalius::k4abt {

/// Returns somebody's joints in the units and axes of the interface. A joint without a place has that of the next joint
/// towards the pelvis that has one, or of the trunk, and no confidence; so has one without a rotation its rotation.
/// `joints` are those of `set`, which is k4abt32.
k4abt_body_t to_body(const TrackedPerson& person, const std::vector<Joint>& joints, const JointSet& set);

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

}  // namespace vesalius::k4abt
