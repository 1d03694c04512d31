#pragma once

#include <optional>

#include "vesalius/appearance.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"

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

}  // namespace vesalius
