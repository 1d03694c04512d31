#include "vesalius/base/assign_pairs.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "vesalius/base/random.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

double sum_of(const Eigen::MatrixXd& cost, const std::vector<int>& column_of) {
  double sum = 0.0;
  for (std::size_t row = 0; row < column_of.size(); ++row) {
    if (column_of[row] >= 0) sum += cost(static_cast<Eigen::Index>(row), column_of[row]);
  }
  return sum;
}

/// Tries all orders of the columns; rows beyond the columns stay free in all ways by columns that cost nothing.
double least_sum(const Eigen::MatrixXd& cost) {
  const Eigen::Index side = std::max(cost.rows(), cost.cols());
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(side, side);
  square.topLeftCorner(cost.rows(), cost.cols()) = cost;
  std::vector<int> order(side);
  std::iota(order.begin(), order.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    least = std::min(least, sum_of(square, order));
  } while (std::ranges::next_permutation(order).found);
  return least;
}

TEST(AssignPairs, TakesTheCheapestPairs) {
  // The cheapest single pair, 1, would leave 9 for the other row.
  EXPECT_THAT(assign_pairs((Eigen::MatrixXd(2, 2) << 1, 2, 3, 9).finished()), ElementsAre(1, 0));
  EXPECT_THAT(assign_pairs((Eigen::MatrixXd(2, 3) << 5, 1, 7, 5, 2, 9).finished()), ElementsAre(1, 0));
  EXPECT_THAT(assign_pairs((Eigen::MatrixXd(3, 1) << 2, -4, 0).finished()), ElementsAre(-1, 0, -1));
}

TEST(AssignPairs, AgreesWithTryingAllOrders) {
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::MatrixXd cost(1 + random.below(6), 1 + random.below(6));
    // Few different costs make many ties.
    for (double& value : cost.reshaped()) value = trial % 2 == 0 ? random.uniform(-1.0, 1.0) : random.below(3);
    const std::vector<int> column_of = assign_pairs(cost);
    EXPECT_NEAR(sum_of(cost, column_of), least_sum(cost), 1e-12);
    std::vector<int> used;
    std::ranges::copy_if(column_of, std::back_inserter(used), [](int column) { return column >= 0; });
    EXPECT_EQ(static_cast<Eigen::Index>(used.size()), std::min(cost.rows(), cost.cols()));
    std::ranges::sort(used);
    EXPECT_EQ(std::ranges::adjacent_find(used), used.end());
  }
}

TEST(AssignPairs, TakesEmptySidesAndRefusesWhatIsNoNumber) {
  EXPECT_THAT(assign_pairs(Eigen::MatrixXd(0, 4)), IsEmpty());
  EXPECT_THAT(assign_pairs(Eigen::MatrixXd(2, 0)), ElementsAre(-1, -1));
  EXPECT_THROW(assign_pairs(Eigen::MatrixXd::Constant(1, 1, std::numeric_limits<double>::infinity())), Error);
}

}  // namespace
}  // namespace vesalius
