#pragma once

#include <string>

#include "vesalius/base/options.h"
#include "vesalius/detect.h"
#include "vesalius/track/track_people.h"

namespace vesalius {

/// The options of all that is done to find people and to follow them.
struct PeopleOptions {
  DetectOptions detect;
  TrackOptions track;
};

/// Options of tracking have names that begin with "track.".
void visit_options(const std::string& prefix, PeopleOptions& options, OptionVisitor& visitor);

}  // namespace vesalius
