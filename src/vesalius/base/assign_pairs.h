#pragma once

#include <Eigen/Core>
#include <vector>

namespace vesalius {

/// Returns for each row of `cost` the column that it is paired with, or -1: as many pairs as rows or columns allow, no
/// column twice, such that the sum of their costs is the smallest (R. Jonker and A. Volgenant 1987, by shortest
/// augmenting paths). The time grows with the smaller side squared times the larger one. Throws Error for a cost that
/// is not finite.
std::vector<int> assign_pairs(const Eigen::MatrixXd& cost);

}  // namespace vesalius
