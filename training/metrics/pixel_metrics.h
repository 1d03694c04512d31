#pragma once

#include <cstdint>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/metric_table.h"
#include "vesalius/body_model.h"
#include "vesalius/image.h"

namespace vesalius {

/// Counts of the pixels with a reading by true and given class; class `parts` is the background.
class PixelConfusion {
 public:
  explicit PixelConfusion(int parts);

  /// Throws Error where the images differ in size or a label is neither a part nor kBackground.
  void add(const LabelImage& truth, const LabelImage& given, const DepthImage& depth);
  void add(const PixelConfusion& other);

  int parts() const { return parts_; }
  std::uint64_t count(int truth, int given) const { return counts_[index(truth, given)]; }
  std::uint64_t of_truth(int truth) const;

 private:
  int index(int truth, int given) const { return truth * (parts_ + 1) + given; }

  int parts_;
  std::vector<std::uint64_t> counts_;
};

/// Returns the intersection over union of two masks on the pixels with a reading; 0 where both are empty. All images
/// must have one size.
double mask_iou(const Mask& a, const Mask& b, const DepthImage& depth);

/// Returns person IoU, background IoU and recall of each part from a frame's confusion with background as a rival, and
/// recall from the confusion `inside` of labels chosen among the parts only.
MetricTerms pixel_terms(const PixelConfusion& with_background, const PixelConfusion& inside, const BodyModel& body);

/// Returns the person IoU of the first pass's labels where only a mask is known, and the share of readings taken for a
/// body in an empty frame. There are no terms where neither is known, or the frame has no reading.
MetricTerms mask_terms(const FrameTruth& truth, const LabelImage& labels, const DepthImage& depth);

}  // namespace vesalius
