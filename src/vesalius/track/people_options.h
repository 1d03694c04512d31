#pragma once

#include <string>

#include "vesalius/base/options.h"
#include "vesalius/detect.h"
#include "vesalius/fit/fit_terms.h"
#include "vesalius/track/track_people.h"

namespace vesalius {

/// The options of all that is done to find people, to follow them and to fit bodies to them.
struct PeopleOptions {
  DetectOptions detect;
  TrackOptions track;
  FitOptions fit;
};
/// Shows the detector's options under their own names, the others as `track.*` and `fit.*`.
void visit_options(const std::string& prefix, PeopleOptions& options, OptionVisitor& visitor);

/// Returns a tracker of the people whom the detector finds, with a body fitted to each. The body model of the
/// detector's forest must outlive it.
/// Throws UsageError for an option outside its range.
PeopleTracker make_tracker(const Detector& detector, const PeopleOptions& options);

/// Finds the people of the frame that comes next, and follows them.
TrackedFrame follow(const Detector& detector, PeopleTracker& tracker, const Frame& frame);

}  // namespace vesalius
