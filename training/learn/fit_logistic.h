#pragma once

#include <Eigen/Core>

namespace vesalius {

/// A logistic regression: the probability is 1 / (1 + exp(-(bias + weights . features))).
struct LogisticFit {
  Eigen::VectorXd weights;
  double bias = 0.0;
};

/// Fits a logistic regression by Newton's method. `features` is [feature][sample], `positive` 1 or 0 for each sample,
/// `weight` how much each counts, above 0. A small ridge on the standardised features keeps the weights finite for
/// samples that a plane separates completely, and gives none to a feature that never changes; `least_spread` is the
/// smallest standard deviation by which a feature is divided. The sums go over the samples in their order, so that the
/// result depends on nothing else.
LogisticFit fit_logistic(const Eigen::MatrixXd& features, const Eigen::VectorXd& positive,
                         const Eigen::VectorXd& weight, double least_spread);

}  // namespace vesalius
