#include "vesalius/track/tracked_frame.h"

#include <limits>
#include <utility>

#include "vesalius/fit/flesh_joints.h"

namespace vesalius {

const char* to_string(TrackState state) {
  switch (state) {
    case TrackState::seen:
      return "seen";
    case TrackState::fresh:
      return "new";
    case TrackState::tracked:
      return "tracked";
    case TrackState::hidden:
      return "hidden";
    default:
      return "lost";
  }
}

const char* to_string(Stance stance) {
  switch (stance) {
    case Stance::standing:
      return "standing";
    case Stance::sitting:
      return "sitting";
    case Stance::lying:
      return "lying";
    case Stance::fallen:
      return "fallen";
    default:
      return "unknown";
  }
}

TrackedFrame seen_people(std::vector<Person> people) {
  TrackedFrame seen;
  seen.followed = false;
  for (Person& person : people) {
    const auto index = int(seen.people.size());
    TrackedPerson& one = seen.people.emplace_back();
    one.id = index;
    one.state = TrackState::seen;
    one.person = std::move(person);
    one.position = one.velocity = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  }
  return seen;
}

std::vector<Person> people_of(const TrackedFrame& tracked) {
  std::vector<Person> people;
  people.reserve(tracked.people.size());
  for (const TrackedPerson& person : tracked.people) people.push_back(person.person);
  return people;
}

std::vector<std::optional<Eigen::Quaternionf>> rotations_of(const TrackedPerson& person, const JointSet& set) {
  if (!person.body) return std::vector<std::optional<Eigen::Quaternionf>>(set.joints.size());
  return joint_rotations(*person.body, builtin_flesh_joints(), set);
}

}  // namespace vesalius
