#pragma once

#include <Eigen/Core>
#include <vector>

#include "vesalius/appearance.h"
#include "vesalius/track/track.h"

namespace vesalius {

/// Returns for each row the column that it is matched with, or -1: the matching of least total cost in which no column
/// has two rows, and a row without column costs `unmatched`. A cost that is not below `unmatched` (infinite, NaN)
/// forbids the pair. It is the exact solution (assign_pairs); of several equally good ones, one that depends on the
/// order only. Takes rows^2 * (rows + columns) steps.
std::vector<int> match_tracks(const Eigen::MatrixXf& costs, float unmatched);

/// What it costs at most that a track and somebody found are one person.
inline constexpr float kMostMatchCost = 12.F;

/// Returns how unlikely it is that somebody found is the one whom the track expects, as a negative logarithm: by the
/// place, the share of the mask where the person was expected, look and size. Infinite where that cannot be, and
/// possibly above kMostMatchCost.
float match_cost(const Track& track, const Sighting& sighting, const Appearance* appearance, double time_s,
                 float same_look);

/// Returns how much somebody found looks unlike somebody lost: the difference of looks, or nothing if looks or size
/// rule it out or are not known.
std::optional<float> return_cost(const Track& lost, const Sighting& sighting, const Appearance* appearance,
                                 double time_s, float same_look);

}  // namespace vesalius
