#pragma once

#include <Eigen/Core>
#include <vector>

namespace vesalius {

/// Returns for each row the column that it is matched with, or -1: the matching of least total cost in which no column
/// has two rows, and a row without column costs `unmatched`. A cost that is not below `unmatched` (infinite, NaN)
/// forbids the pair. It is the exact solution (assign_pairs); of several equally good ones, one that depends on the
/// order only. Takes rows^2 * (rows + columns) steps.
std::vector<int> match_tracks(const Eigen::MatrixXf& costs, float unmatched);

}  // namespace vesalius
