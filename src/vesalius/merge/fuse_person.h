#pragma once

#include <vector>

#include "vesalius/person.h"

namespace vesalius {

/// Returns one person of the same one as several cameras know them, all in one frame; `seen` must not be empty. Each
/// joint is the mean of the cameras', weighted by the inverses of the variances that their confidences stand for
/// (sigma_of), those of predicted ones larger. Who is far from the surest one, as variances go, does not count. The
/// joint is observed where one of them observed it, and at least as sure as the surest. Parts likewise. Why
/// they are not observed is left open (explain_unseen). Everything else is that of the first.
TrackedPerson fuse_person(const std::vector<const TrackedPerson*>& seen);

}  // namespace vesalius
