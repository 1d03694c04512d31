#pragma once

#include <vector>

#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"
#include "vesalius/person.h"

namespace vesalius {

/// Fewest pixels of a person that can say where the person's parts are.
inline constexpr int kLeastPartVotes = 4;

/// Returns where the pixels of one person, those where `person` is not 0, say that each part is, seen or hidden: the
/// median along each axis of the eighth of the votes that come from nearest to it. Pixels without a reading say
/// nothing. Returns nothing for fewer than kLeastPartVotes of them, or where the labeller does not know.
std::vector<VotedPart> vote_parts(const PartVotes& votes, const Frame& frame, const Mask& person);

/// Returns the standard deviation along each axis with which a voted centre counts, metres: about its error on rendered
/// people.
double voted_sigma_m(const VotedPart& part);

}  // namespace vesalius
