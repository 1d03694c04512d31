#include "vesalius/base/assign_pairs.h"

#include <limits>

#include "vesalius/error.h"

namespace vesalius {
namespace {

/// Pairs of a matrix with at most as many rows as columns. Prices of rows and columns keep every reduced cost, that is
/// cost - price of the row - price of the column, at 0 or above, and at 0 for the pairs.
class Assignment {
 public:
  explicit Assignment(const Eigen::MatrixXd& cost)
      : cost_(cost), row_price_(cost.rows(), 0.0), column_price_(cost.cols(), 0.0), row_of_(cost.cols(), -1) {}

  std::vector<int> run() {
    for (int row = 0; row < cost_.rows(); ++row) augment(row);
    std::vector<int> column_of(cost_.rows(), -1);
    for (int column = 0; column < cost_.cols(); ++column) {
      if (row_of_[column] >= 0) column_of[row_of_[column]] = column;
    }
    return column_of;
  }

 private:
  /// Pairs a free row along the shortest path of reduced costs to a free column; the pairs on it move by one.
  void augment(int free_row) {
    const auto columns = int(cost_.cols());
    std::vector<double> distance(columns, std::numeric_limits<double>::infinity());
    std::vector<int> before(columns, -1);  // column before this one on the path, or -1 for the free row
    std::vector<bool> reached(columns, false);
    int row = free_row, last = -1;
    double travelled = 0.0;
    for (;;) {
      int next = -1;
      for (int c = 0; c < columns; ++c) {
        if (reached[c]) continue;
        const double through = travelled + cost_(row, c) - row_price_[row] - column_price_[c];
        if (through < distance[c]) {
          distance[c] = through;
          before[c] = last;
        }
        if (next < 0 || distance[c] < distance[next]) next = c;
      }
      last = next;
      travelled = distance[next];
      if (row_of_[next] < 0) break;
      reached[next] = true;
      row = row_of_[next];
    }
    for (int c = 0; c < columns; ++c) {
      if (!reached[c]) continue;
      row_price_[row_of_[c]] += travelled - distance[c];
      column_price_[c] -= travelled - distance[c];
    }
    row_price_[free_row] += travelled;
    for (; before[last] >= 0; last = before[last]) row_of_[last] = row_of_[before[last]];
    row_of_[last] = free_row;
  }

  const Eigen::MatrixXd& cost_;
  std::vector<double> row_price_, column_price_;
  std::vector<int> row_of_;  ///< the row of each column, or -1
};

}  // namespace

std::vector<int> assign_pairs(const Eigen::MatrixXd& cost) {
  if (!cost.allFinite()) throw Error("pairs of least cost: a cost that is not finite");
  if (cost.rows() <= cost.cols()) return Assignment(cost).run();
  const Eigen::MatrixXd turned = cost.transpose();
  const std::vector<int> row_of = Assignment(turned).run();
  std::vector<int> column_of(cost.rows(), -1);
  for (std::size_t column = 0; column < row_of.size(); ++column) column_of[row_of[column]] = int(column);
  return column_of;
}

}  // namespace vesalius
