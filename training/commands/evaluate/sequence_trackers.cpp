#include "commands/evaluate/sequence_trackers.h"

#include <utility>

namespace vesalius::cli {

SequenceTrackerFactory sequence_trackers(Model model, const PeopleOptions& options) {
  const auto detector = std::make_shared<const Detector>(std::move(model), options.detect);
  return [detector, options] {
    // A tracker refers to the detector's body, so that both live as long as this function.
    const auto tracker = std::make_shared<PeopleTracker>(make_tracker(*detector, options));
    return [detector, tracker](const Frame& frame) {
      Detection found = detector->detect(frame, [&](const Frame& asked) { return tracker->expect(asked); });
      return tracker->update(frame, std::move(found.people), found.planes);
    };
  };
}

}  // namespace vesalius::cli
