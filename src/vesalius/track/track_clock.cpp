#include "vesalius/track/track_clock.h"

#include <cmath>

namespace vesalius {
namespace {

bool has_time(const Frame& frame) { return frame.time_s && std::isfinite(*frame.time_s); }

}  // namespace

TrackStep TrackClock::step_to(const Frame& frame) const {
  if (frames_ == 0) return {has_time(frame) ? *frame.time_s : 0.0, 0.0, false};
  const double untimed_s = timed_ ? last_s_ + period_s_ : double(frames_) * period_s_;
  const double time_s = has_time(frame) ? *frame.time_s : untimed_s;
  const double passed_s = time_s - last_s_;
  const bool goes_on = passed_s >= 0.0 && passed_s <= gap_s_;
  return {time_s, goes_on ? passed_s : 0.0, !goes_on};
}

void TrackClock::go(const Frame& frame) {
  last_s_ = step_to(frame).time_s;
  timed_ = timed_ || has_time(frame);
  ++frames_;
}

}  // namespace vesalius
