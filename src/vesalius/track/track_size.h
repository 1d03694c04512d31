#pragma once

#include <optional>

#include "vesalius/base/body_model.h"
#include "vesalius/search_skeletons.h"

namespace vesalius {

/// Returns how large a person is against the body model's adult: the median ratio of the lengths of those links whose
/// parts were both seen. Nothing if fewer than kLeastLinks were.
std::optional<float> body_scale(const Skeleton& skeleton, const BodyModel& body);
inline constexpr int kLeastLinks = 5;

/// The size of somebody who is followed, learned over frames: a mean of logarithms, in which no frame counts for ever.
class TrackSize {
 public:
  void add(float scale);
  /// Returns the squared difference of two sizes in standard deviations of their difference; 0 if one is not known.
  static float distance2(const TrackSize& a, const TrackSize& b);

 private:
  float mean_log_ = 0.F;
  float frames_ = 0.F;  ///< at most kMostFrames
};

}  // namespace vesalius
