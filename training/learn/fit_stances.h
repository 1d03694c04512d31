#pragma once

#include <array>
#include <vector>

#include "metrics/fit_samples.h"
#include "vesalius/track/stance_model.h"

namespace vesalius {

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
