#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "vesalius/base/body_model.h"
#include "vesalius/fit/joint_trust.h"
#include "vesalius/track/tracked_frame.h"

namespace vesalius {

/// A joint that was given out by a fitted body, and whether it was right.
struct TrustSample {
  JointSource source = JointSource::observed;
  TrustSignals signals;
  bool right = false;  ///< within kJointTolerance_m of the truth
};

/// Adds a sample for each joint of a person that comes from the fitted body (builtin_flesh_joints) and whose truth is
/// known. `names` and `truth` (metres, optical frame; NaN = not known) have one order; the places are those of
/// found.person.joints.
void add_trust_samples(const TrackedPerson& found, const std::vector<JointSet>& sets, const JointSet& set,
                       const std::vector<std::string>& names, const std::vector<Eigen::Vector3f>& truth,
                       std::vector<TrustSample>& samples);

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
