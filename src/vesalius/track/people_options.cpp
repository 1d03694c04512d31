#include "vesalius/track/people_options.h"

#include <memory>
#include <utility>

#include "vesalius/fit/fit_body.h"

namespace vesalius {

void visit_options(const std::string& prefix, PeopleOptions& options, OptionVisitor& visitor) {
  visit_options(prefix, options.detect, visitor);
  visit_options(prefix + "track.", options.track, visitor);
  visit_options(prefix + "fit.", options.fit, visitor);
}

PeopleTracker make_tracker(const Detector& detector, const PeopleOptions& options) {
  return PeopleTracker(detector.body(), options.track, detector.appearance(),
                       std::make_shared<const BodyFitter>(detector.body(), options.fit));
}

TrackedFrame follow(const Detector& detector, PeopleTracker& tracker, const Frame& frame) {
  Detection found = detector.detect(frame, [&](const Frame& asked) { return tracker.expect(asked); });
  return tracker.update(frame, std::move(found.people), found.planes);
}

}  // namespace vesalius
