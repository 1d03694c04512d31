#include "vesalius/track/track_clock.h"

#include <cmath>

namespace vesalius {
namespace {

constexpr double kMostLate_s = 1.0;  // pictures wait in queues of drivers and recorders for less

bool has_time(const Frame& frame) { return frame.time_s && std::isfinite(*frame.time_s); }

}  // namespace

TrackStep TrackClock::step_to(const Frame& frame) const {
  if (frames_ == 0) return {has_time(frame) ? *frame.time_s : 0.0, 0.0, false};
  const double untimed_s = timed_ ? last_s_ + period_s_ : double(frames_) * period_s_;
  const double time_s = has_time(frame) ? *frame.time_s + set_back_s_ : untimed_s;
  const double passed_s = time_s - last_s_;
  if (passed_s >= 0.0 && passed_s <= gap_s_) return {time_s, passed_s, false};
  if (passed_s < 0.0 && passed_s > -kMostLate_s) {
    const double since_late_s = late_s_ && time_s >= *late_s_ ? time_s - *late_s_ : 0.0;
    return {last_s_ + since_late_s, since_late_s, false};
  }
  return {has_time(frame) ? *frame.time_s : time_s, 0.0, true};
}

void TrackClock::go(const Frame& frame) {
  const TrackStep step = step_to(frame);
  timed_ = timed_ || has_time(frame);
  const double own_s = has_time(frame) ? *frame.time_s + set_back_s_ : step.time_s;
  if (frames_++ == 0 || step.jump) {
    set_back_s_ = 0.0;
    late_s_.reset();
  } else if (own_s >= last_s_) {
    late_s_.reset();
  } else if (late_s_ && own_s >= *late_s_) {
    set_back_s_ += step.time_s - own_s;
    late_s_.reset();
  } else {
    late_s_ = own_s;
  }
  last_s_ = step.time_s;
}

}  // namespace vesalius
