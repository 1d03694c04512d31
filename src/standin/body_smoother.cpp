#include "standin/body_smoother.h"

#include <algorithm>
#include <utility>

namespace vesalius::standin {
namespace {

constexpr float kStrongest = 0.9F;  ///< share of a change that the strongest smoothing holds back

}  // namespace

JointSmoothing smoothing_of(float factor) {
  const JointSmoothing usual;
  const float held = kStrongest * factor;
  const float share = (1.F - held) / held;
  return {usual.cutoff_hz * share, usual.cutoff_per_m_s * share};
}

std::vector<Joint> BodySmoother::smooth(const TrackedPerson& person, std::size_t set, double time_s, float factor) {
  const std::vector<Joint>& joints = person.person.joints[set];
  if (factor <= 0.F) {
    followed_.erase(person.id);
    return joints;
  }
  Followed& followed = followed_[person.id];
  auto smoothed = followed.smoother.smooth({joints}, time_s - followed.time_s, smoothing_of(factor));
  followed.time_s = time_s;
  return std::move(smoothed.front());
}

void BodySmoother::keep(const TrackedFrame& frame) {
  std::erase_if(followed_, [&](const auto& one) {
    return std::ranges::none_of(frame.people, [&](const TrackedPerson& person) { return person.id == one.first; });
  });
}

}  // namespace vesalius::standin
