#pragma once

#include <optional>

#include "vesalius/appearance.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/person.h"

namespace vesalius {

/// Returns what a person's pixels look like, taken from the grid of pixels at which a detector looks. Only the pixels
/// about `box`, the smallest box around `mask`, are looked at. It has no samples where the frame lacks what the
/// appearance takes, or without an appearance.
AppearanceHistogram look_of(const Frame& frame, const Mask& mask, const Box& box, const Appearance* appearance);

/// What somebody who is followed looks like (section 9: the appearance model carried over frames). Older frames count
/// less and less.
class TrackLook {
 public:
  void add_histogram(const AppearanceHistogram& frame);
  const AppearanceHistogram& histogram() const { return histogram_; }

 private:
  AppearanceHistogram histogram_;
};

/// Returns how different two looks are: the Bhattacharyya distance (1943) of their histograms, 0 for the same. Nothing
/// if one has too few pixels to tell.
std::optional<float> look_distance(const AppearanceHistogram& a, const AppearanceHistogram& b,
                                   const Appearance* appearance);

/// Returns how large a person is against the body model's adult: the median ratio of the lengths of those links whose
/// parts were both seen. Nothing if fewer than kLeastLinks were.
std::optional<float> body_scale(const Skeleton& skeleton, const BodyModel& body);
inline constexpr int kLeastLinks = 5;

/// The size of somebody who is followed, learned over frames: a mean of logarithms, in which no frame counts for ever,
/// and the size of the fitted body. Pose and what is seen bias the one, clothes the other, so that both together tell
/// more.
class TrackSize {
 public:
  /// Takes what body_scale says of a frame.
  void add_scale(float scale);
  /// Takes how tall the fitted body is against the mean body (BodyHistory::size), in place of what was known of it;
  /// nothing if that is not known, or not any more.
  void fit(std::optional<float> size);
  /// Returns the squared difference of two sizes in standard deviations of their difference; 0 if one is not known.
  static float distance2(const TrackSize& a, const TrackSize& b);

 private:
  /// A logarithm of body_scale and its variance, which is infinite where nothing is known.
  struct Estimate {
    float log = 0.F, variance = 0.F;
  };
  Estimate estimate() const;

  float mean_log_ = 0.F;
  float frames_ = 0.F;               ///< frames that count, at most kMostFrames
  std::optional<float> fitted_log_;  ///< what body_scale would say of the fitted body
};

}  // namespace vesalius
