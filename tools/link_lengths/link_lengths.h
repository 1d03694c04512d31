#pragma once

#include <array>
#include <vector>

#include "metrics/frame_truth.h"
#include "vesalius/body_model.h"

namespace vesalius {

/// The stature to which people are scaled, metres.
inline constexpr float kReferenceStature_m = 1.7F;
/// Upper ends of the bands of stature, metres; one more band is above them. All bands weigh alike, since a population
/// has few children.
inline constexpr std::array<float, 4> kStatureBands_m = {1.2F, 1.4F, 1.6F, 1.8F};

/// The distances between the centres of two linked parts, metres. Left and right are taken together. NaN where nothing
/// was measured.
struct LinkFigures {
  long pairs = 0;               ///< people with both parts in view
  float length_m = 0.F;         ///< median
  float spread_m = 0.F;         ///< deviation from it that 90 % do not exceed
  float scaled_spread_m = 0.F;  ///< the same after scaling everybody to the reference stature
  std::array<float, kStatureBands_m.size() + 1> band_m{};  ///< median of each band
};

/// Measures link lengths over labelled people of known stature.
class LinkLengths {
 public:
  explicit LinkLengths(const BodyModel& body);

  /// Adds the people of a frame: of each person and part the largest cluster that the search would be offered.
  /// `labels` are the true ones or those of a forest, of the frame's size. People of unknown stature are left out.
  void add(const TrueFrame& frame, const LabelImage& labels);

  /// Returns one entry for each link of the body, in its order.
  std::vector<LinkFigures> figures() const;

 private:
  struct Sample {
    float distance_m;
    float stature_m;
  };

  const BodyModel& body_;
  std::vector<int> twin_;                     ///< [link] the first of its mirror pair
  std::vector<std::vector<Sample>> samples_;  ///< [link], at its twin
};

}  // namespace vesalius
