#include "vesalius/track/people_options.h"

namespace vesalius {

void visit_options(const std::string& prefix, PeopleOptions& options, OptionVisitor& visitor) {
  visit_options(prefix, options.detect, visitor);
  visit_options(prefix + "track.", options.track, visitor);
  visit_options(prefix + "fit.", options.fit, visitor);
}

}  // namespace vesalius
