#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "metrics/fit_samples.h"
#include "vesalius/fit/joint_trust.h"
#include "vesalius/track/stance_model.h"

namespace vesalius {

/// A logistic regression: the probability is 1 / (1 + exp(-(bias + weights . features))).
struct LogisticFit {
  Eigen::VectorXd weights;
  double bias = 0.0;
};

/// Fits a logistic regression by Newton's method. `features` is [feature][sample], `positive` 1 or 0 for each sample,
/// `weight` how much each counts, above 0. A small ridge on the standardised features keeps the weights finite for
/// samples that a plane separates completely, and gives none to a feature that never changes. The sums go over the
/// samples in their order, so that the result depends on nothing else.
LogisticFit fit_logistic(const Eigen::MatrixXd& features, const Eigen::VectorXd& positive,
                         const Eigen::VectorXd& weight);

/// Does the same with features as they are: `ridge` is on the weights, and none on the bias.
LogisticFit fit_standard_logistic(const Eigen::MatrixXd& features, const Eigen::VectorXd& positive,
                                  const Eigen::VectorXd& weight, double ridge);

/// Fewest right and fewest wrong samples of one kind to which its trust is fitted.
inline constexpr long kLeastTrustSamples = 200;

/// How well the confidence of one kind of joints agrees with the shares that are right.
struct TrustAgreement {
  long samples = 0;
  long right = 0;
  bool fitted = false;  ///< there were enough of them
  double before = 0.0;  ///< mean |share right - mean confidence| over the tenths of confidence, by samples in them
  double after = 0.0;   ///< the same with the trust that was fitted
};

struct TrustFit {
  BodyTrust trust;
  std::array<TrustAgreement, kJointSources.size()> agreement;  ///< [JointSource]
};

/// Fits the trust in each kind of joints by logistic regression; every sample counts the same. Kinds of which there are
/// fewer than kLeastTrustSamples right or wrong ones keep that of `start`. Throws Error if all do.
TrustFit fit_trust(const std::vector<TrustSample>& samples, const BodyTrust& start);

/// Fewest samples of each stance to which a model is fitted.
inline constexpr long kLeastStanceSamples = 100;

/// How often the likeliest stance of one frame alone is the true one.
struct StanceAgreement {
  Stance stance = Stance::unknown;
  long samples = 0;
  long right_before = 0;
  long right_after = 0;  ///< with the model that was fitted
};

struct StanceFit {
  StanceModel model;
  std::array<StanceAgreement, 3> agreement{StanceAgreement{Stance::standing}, StanceAgreement{Stance::sitting},
                                           StanceAgreement{Stance::lying}};
};

/// Fits how probable stances are by logistic regression; each stance counts the same. Everybody counts also without the
/// floor, and whoever lies also as high as on a mattress and on a bed, since rendered people lie on the floor alone.
/// Throws Error if there are fewer than kLeastStanceSamples of a stance.
StanceFit fit_stances(const std::vector<StanceSample>& samples, const StanceModel& start);

}  // namespace vesalius
