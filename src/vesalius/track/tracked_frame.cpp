#include "vesalius/track/tracked_frame.h"

namespace vesalius {

const char* to_string(TrackState state) {
  switch (state) {
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

std::vector<Person> people_of(const TrackedFrame& tracked) {
  std::vector<Person> people;
  people.reserve(tracked.people.size());
  for (const TrackedPerson& person : tracked.people) people.push_back(person.person);
  return people;
}

}  // namespace vesalius
