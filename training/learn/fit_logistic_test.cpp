#include "learn/fit_logistic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

/// Samples of two features, positive with the probability that weights and bias give.
struct Drawn {
  Eigen::MatrixXd features;
  Eigen::VectorXd positive, weight;
};

Drawn drawn(const LogisticFit& truth, Eigen::Index count) {
  Random random(5);
  Drawn d{Eigen::MatrixXd(2, count), Eigen::VectorXd(count), Eigen::VectorXd::Ones(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    d.features(0, i) = random.normal(3.0, 2.0);
    d.features(1, i) = random.normal(0.0, 0.1);
    const double logit = truth.bias + truth.weights.dot(d.features.col(i));
    d.positive[i] = random.uniform() < 1.0 / (1.0 + std::exp(-logit)) ? 1.0 : 0.0;
  }
  return d;
}

TEST(FitLogistic, FindsTheWeightsThatMadeTheSamples) {
  const LogisticFit truth{Eigen::Vector2d(-0.6, 8.0), 1.5};
  const Drawn d = drawn(truth, 40000);
  const LogisticFit fit = fit_logistic(d.features, d.positive, d.weight, 1e-3);
  EXPECT_NEAR(fit.weights[0], -0.6, 0.03);
  EXPECT_NEAR(fit.weights[1], 8.0, 0.4);
  EXPECT_NEAR(fit.bias, 1.5, 0.1);
}

TEST(FitLogistic, ASampleThatWeighsTwiceIsTwoSamples) {
  Drawn d = drawn({Eigen::Vector2d(-0.6, 8.0), 1.5}, 500);
  d.weight.head(100).setConstant(2.0);
  Drawn twice{Eigen::MatrixXd(2, 600), Eigen::VectorXd(600), Eigen::VectorXd::Ones(600)};
  twice.features << d.features, d.features.leftCols(100);
  twice.positive << d.positive, d.positive.head(100);
  const LogisticFit a = fit_logistic(d.features, d.positive, d.weight, 1e-3);
  const LogisticFit b = fit_logistic(twice.features, twice.positive, twice.weight, 1e-3);
  // The ridge is on features that are standardised by the samples as they are, so that they differ a little.
  EXPECT_NEAR(a.weights[0], b.weights[0], 2e-3);
  EXPECT_NEAR(a.weights[1], b.weights[1], 2e-2);
}

TEST(FitLogistic, StaysFiniteWhereAPlaneSeparatesAll) {
  Drawn d = drawn({Eigen::Vector2d::Zero(), 0.0}, 200);
  for (Eigen::Index i = 0; i < 200; ++i) d.positive[i] = d.features(0, i) > 3.0 ? 1.0 : 0.0;
  const LogisticFit fit = fit_logistic(d.features, d.positive, d.weight, 1e-3);
  EXPECT_TRUE(fit.weights.allFinite() && std::isfinite(fit.bias));
  EXPECT_GT(fit.weights[0], 0.5);
}

TEST(FitLogistic, AFeatureThatNeverChangesGetsNoWeight) {
  Drawn d = drawn({Eigen::Vector2d(-0.6, 0.0), 1.5}, 1000);
  d.features.row(1).setConstant(4.0);
  EXPECT_NEAR(fit_logistic(d.features, d.positive, d.weight, 1e-3).weights[1], 0.0, 1e-9);
}

}  // namespace
}  // namespace vesalius
