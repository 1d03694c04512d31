#pragma once

#include <optional>

#include "vesalius/frame.h"

namespace vesalius {

/// How a frame follows in time on the one before.
struct TrackStep {
  double time_s = 0.0;    ///< time of the frame; never falls but in a jump
  double passed_s = 0.0;  ///< since the frame before; 0 after a jump
  bool jump = false;      ///< whether the frame does not go on from the one before
};

/// Tells the times of frames, of which some may have none or nonsense.
class TrackClock {
 public:
  /// `rate` is that of frames without times, per second. A step of more than `gap_s` seconds, or of one backwards, is a
  /// jump. A frame that is less late than that takes no time; if those after it go on from there, the clock was set
  /// back and time goes on as well.
  TrackClock(double rate, double gap_s) : period_s_(1.0 / rate), gap_s_(gap_s) {}

  /// Returns the step to a frame that comes next. A time that is not finite counts as none. Without times frames are
  /// numbered from 0; one without amid others comes a period after the one before.
  TrackStep step_to(const Frame& frame) const;
  /// Goes there.
  void go(const Frame& frame);

 private:
  double period_s_, gap_s_;
  long frames_ = 0;
  bool timed_ = false;            ///< whether any frame had a time
  double last_s_ = 0.0;           ///< time of the latest frame
  std::optional<double> late_s_;  ///< time of the frame before if that was late
  double set_back_s_ = 0.0;       ///< by how much the clock was since the last jump
};

}  // namespace vesalius
