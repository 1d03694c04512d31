#pragma once

#include <cstdint>
#include <vector>

#include "eval/figure_table.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame_truth.h"
#include "vesalius/base/image.h"

namespace vesalius {

/// Pixels with a reading by true and given class; class `parts` is the background.
class PixelConfusion {
 public:
  explicit PixelConfusion(int parts);

  /// Throws Error where the images differ in size or a label is neither a part nor kBackground.
  void add(const LabelImage& truth, const LabelImage& given, const DepthImage& depth);
  void add(const PixelConfusion& other);

  int parts() const { return parts_; }
  std::uint64_t count(int truth, int given) const { return counts_[index(truth, given)]; }
  std::uint64_t of_truth(int truth) const;
  /// Share of the true pixels of a class that were given it; NaN where there are none.
  double recall(int truth) const;
  /// Mean recall of the parts that occur: mean per-class accuracy with whatever rivals the given labels had.
  double mean_recall() const;
  /// Intersection over union of all parts together, and of the background; NaN where neither side has any.
  double person_iou() const;
  double background_iou() const;

 private:
  std::size_t index(int truth, int given) const {
    return static_cast<std::size_t>(truth) * static_cast<std::size_t>(parts_ + 1) + static_cast<std::size_t>(given);
  }

  int parts_;
  std::vector<std::uint64_t> counts_;
};

/// Intersection over union of two masks on the pixels with a reading; 0 where both are empty. All of one size.
double mask_iou(const Mask& a, const Mask& b, const DepthImage& depth);

/// Person IoU, background IoU and recall of each part from a frame's confusion with background as a rival, and recall
/// from the confusion of labels chosen among the parts only.
FigureTerms pixel_terms(const PixelConfusion& with_background, const PixelConfusion& inside, const BodyModel& body);

/// What `labels` of the first pass say where only a mask is known, or that nobody is there: person IoU, or the share
/// of readings taken for a body. No terms where neither is known, or the frame has no reading.
FigureTerms mask_terms(const FrameTruth& truth, const LabelImage& labels, const DepthImage& depth);

}  // namespace vesalius
