#pragma once

#include <array>
#include <vector>

#include "metrics/fit_samples.h"
#include "vesalius/fit/joint_trust.h"

namespace vesalius {

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

}  // namespace vesalius
