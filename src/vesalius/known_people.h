#pragma once

#include <vector>

#include "vesalius/base/capsule.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"
#include "vesalius/prior.h"

namespace vesalius {

/// Greatest distance of a pixel from a known person's flesh at which the flesh tells anything, metres.
inline constexpr float kFleshReach_m = 0.2F;

/// Returns for each pixel how far its point is outside of the nearest capsule, metres (below 0 inside), or infinity
/// from `reach_m` on and where there is no reading.
Image<float> distance_from(const std::vector<Capsule>& capsules, const Frame& frame, float reach_m);

/// Which pixels of a frame belong to people whose flesh is expected somewhere (Prior::KnownPerson::flesh). A pixel is
/// somebody's if its point is nearer to this one's flesh than to that of any other, and if it is more likely body than
/// not, by the forest's posterior and the distance together.
class KnownPeople {
 public:
  /// `flat` is 1 on floor, walls and other large flat surfaces. Fills the masks of those people of `prior` whose flesh
  /// is known: non-zero on their pixels. All must outlive it.
  KnownPeople(const Frame& frame, const Mask& flat, const Posteriors& posteriors, int parts, Prior& prior);

  /// Returns the index of the known person whose mask a mask overlaps most, at least by kKnownOverlap, or -1.
  int shown_by(const Mask& mask) const;

  /// Takes from the mask of known person `owner` (-1: nobody known) what belongs to other people who are sure. If the
  /// owner's flesh is known, adds what surely belongs to the owner, and, if the owner is `at_flesh`, takes away what is
  /// neither near nor body.
  void correct(int owner, bool at_flesh, Mask& mask) const;

 private:
  void give(std::size_t pixel, const std::vector<Image<float>>& distance, Prior& prior);

  const Prior& prior_;
  const Posteriors& posteriors_;
  int parts_;
  Image<std::uint8_t> owner_;  ///< index of the person with odds above 1 to whom a pixel belongs; empty without flesh
};

}  // namespace vesalius
