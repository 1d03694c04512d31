#include "vesalius/track/match_tracks.h"

#include <limits>

namespace vesalius {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Adds rows one by one; each takes the cheapest column that it can get by moving others.
class Assignment {
 public:
  /// Column `columns + i` stands for no partner of row i.
  Assignment(const Eigen::MatrixXf& costs, float unmatched)
      : costs_(costs),
        unmatched_(static_cast<double>(unmatched)),
        rows_(static_cast<int>(costs.rows())),
        columns_(static_cast<int>(costs.cols() + costs.rows())),
        row_price_(rows_, 0.0),
        column_price_(columns_, 0.0),
        row_of_(columns_, -1) {}

  std::vector<int> solve() {
    for (int row = 0; row < rows_; ++row) add(row);
    std::vector<int> match(rows_, -1);
    for (int column = 0; column < costs_.cols(); ++column) {
      if (row_of_[column] >= 0) match[row_of_[column]] = column;
    }
    return match;
  }

 private:
  double cost(int row, int column) const {
    if (column >= costs_.cols()) return column - costs_.cols() == row ? unmatched_ : kInfinity;
    const auto value = static_cast<double>(costs_(row, column));
    return value < unmatched_ ? value : kInfinity;
  }

  void add(int added) {
    std::vector<double> least(columns_, kInfinity);  // of a path from the added row to each column
    std::vector<int> before(columns_, -1);           // the column before it on that path
    std::vector<bool> done(columns_, false);
    int row = added, from = -1;
    double base = 0.0;
    for (;;) {
      int next = -1;
      for (int column = 0; column < columns_; ++column) {
        if (done[column]) continue;
        const double length = base + cost(row, column) - row_price_[row] - column_price_[column];
        if (length < least[column]) {
          least[column] = length;
          before[column] = from;
        }
        if (least[column] < kInfinity && (next < 0 || least[column] < least[next])) next = column;
      }
      done[next] = true;  // a row can always stay without partner, so there is one
      base = least[next];
      from = next;
      if (row_of_[next] < 0) break;
      row = row_of_[next];
    }
    row_price_[added] += base;
    for (int column = 0; column < columns_; ++column) {
      if (!done[column] || row_of_[column] < 0) continue;
      row_price_[row_of_[column]] += base - least[column];
      column_price_[column] -= base - least[column];
    }
    for (int column = from; column >= 0; column = before[column]) {
      row_of_[column] = before[column] >= 0 ? row_of_[before[column]] : added;
    }
  }

  const Eigen::MatrixXf& costs_;
  const double unmatched_;
  const int rows_, columns_;
  std::vector<double> row_price_, column_price_;
  std::vector<int> row_of_;  ///< -1: the column is free
};

}  // namespace

std::vector<int> match_tracks(const Eigen::MatrixXf& costs, float unmatched) {
  return Assignment(costs, unmatched).solve();
}

}  // namespace vesalius
