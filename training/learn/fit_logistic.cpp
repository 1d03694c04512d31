#include "learn/fit_logistic.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "vesalius/base/logistic.h"

namespace vesalius {
namespace {

constexpr double kRidge = 1e-3;  // per unit of the samples' weight, on standardised features
constexpr int kMostSteps = 100;
constexpr double kSmallestStep = 1e-10;

}  // namespace

LogisticFit fit_logistic(const Eigen::MatrixXd& features, const Eigen::VectorXd& positive,
                         const Eigen::VectorXd& weight, double least_spread) {
  const Eigen::Index count = features.rows(), samples = features.cols();
  const auto all = double(samples);
  const Eigen::VectorXd mean = features.rowwise().sum() / all;
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(count);
  for (Eigen::Index s = 0; s < samples; ++s) spread += (features.col(s) - mean).cwiseAbs2();
  spread = (spread / all).cwiseSqrt().cwiseMax(least_spread);

  Eigen::MatrixXd ridge = Eigen::MatrixXd::Zero(count + 1, count + 1);
  ridge.diagonal().head(count).setConstant(kRidge * weight.sum());
  Eigen::VectorXd w = Eigen::VectorXd::Zero(count + 1), x(count + 1);  // the bias last
  x[count] = 1.0;
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::VectorXd slope = -(ridge * w);
    Eigen::MatrixXd curvature = ridge;
    for (Eigen::Index s = 0; s < samples; ++s) {
      x.head(count) = (features.col(s) - mean).cwiseQuotient(spread);
      const double p = logistic(w.dot(x));
      slope += weight[s] * (positive[s] - p) * x;
      curvature.selfadjointView<Eigen::Lower>().rankUpdate(x, weight[s] * p * (1.0 - p));
    }
    const Eigen::VectorXd change = curvature.selfadjointView<Eigen::Lower>().ldlt().solve(slope);
    w += change;
    if (change.norm() < kSmallestStep) break;
  }
  LogisticFit fit;
  fit.weights = w.head(count).cwiseQuotient(spread);
  fit.bias = w[count] - fit.weights.dot(mean);
  return fit;
}

}  // namespace vesalius
