#include "vesalius/track/match_tracks.h"

#include "vesalius/base/assign_pairs.h"

namespace vesalius {

std::vector<int> match_tracks(const Eigen::MatrixXf& costs, float unmatched) {
  // Each row has a column of its own to be without partner in. Forbidden pairs cost more than that, so that none is
  // ever taken.
  const double alone = double(unmatched);
  const double forbidden = alone + 1.0;
  Eigen::MatrixXd all = Eigen::MatrixXd::Constant(costs.rows(), costs.cols() + costs.rows(), forbidden);
  all.rightCols(costs.rows()).diagonal().setConstant(alone);
  for (Eigen::Index column = 0; column < costs.cols(); ++column) {
    for (Eigen::Index row = 0; row < costs.rows(); ++row) {
      if (costs(row, column) < unmatched) all(row, column) = double(costs(row, column));
    }
  }
  std::vector<int> match = assign_pairs(all);
  for (int& column : match) {
    if (column >= costs.cols()) column = -1;
  }
  return match;
}

}  // namespace vesalius
