#include "metrics/frame_truth.h"

namespace vesalius {

const char* to_string(Heading heading) {
  switch (heading) {
    case Heading::front:
      return "front";
    case Heading::side:
      return "side";
    default:
      return "back";
  }
}

Mask labelled_people(const FrameTruth& truth) {
  constexpr std::uint8_t kMost = 254;
  Mask people(truth.labels.width(), truth.labels.height(), 0);
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (truth.labels[i] == kBackground) continue;
    const bool known = !truth.person.empty() && truth.person[i] < kMost;
    people[i] = static_cast<std::uint8_t>(known ? truth.person[i] + 1 : 1);
  }
  return people;
}

}  // namespace vesalius
