#include "vesalius/person.h"

#include <limits>
#include <utility>

namespace vesalius {

Image<std::uint8_t> body_index_map(const std::vector<Person>& people, int width, int height) {
  Image<std::uint8_t> map(width, height, kBackground);
  for (std::size_t p = 0; p < people.size() && p < kBackground; ++p) {
    if (people[p].mask.empty()) continue;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (people[p].mask[i] != 0) map[i] = static_cast<std::uint8_t>(p);
    }
  }
  return map;
}

LabelImage part_label_map(const std::vector<Person>& people, int width, int height) {
  LabelImage map(width, height, kBackground);
  for (const Person& person : people) {
    if (person.mask.empty()) continue;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (person.mask[i] != 0) map[i] = person.labels[i];
    }
  }
  return map;
}

const char* to_string(Unseen unseen) {
  switch (unseen) {
    case Unseen::none:
      return "none";
    case Unseen::out_of_picture:
      return "out_of_picture";
    case Unseen::behind_person:
      return "behind_person";
    case Unseen::behind_something:
      return "behind_something";
    case Unseen::no_depth:
      return "no_depth";
    default:
      return "not_sure";
  }
}

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

}  // namespace vesalius
