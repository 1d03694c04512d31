#pragma once

#include <vector>

#include "vesalius/appearance.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/person.h"

namespace vesalius {

/// What earlier frames tell about the people of a frame; a tracker provides it. Each mask that no
/// candidate with a sufficient score covers starts a candidate of its own: its pixels are taken as that person's
/// whatever the background's posterior is, and the candidate is labelled, searched for a skeleton, grown, refined and
/// scored like any other. So a person whom labels alone would lose can be found again, but only with a sufficient score
/// in this frame; how high it must be follows from `odds`. A Prior without people changes nothing.
struct Prior {
  struct KnownPerson {
    /// Non-zero where the person is expected, such as the mask of the previous frame, perhaps moved. It has the frame's
    /// size, or is empty if the place is unknown; then this person starts no candidate.
    Mask mask;
    /// What the person looked like in earlier frames (learn_appearance, with the detector's appearance), to which the
    /// looks in this frame are added before the mask grows. It has no samples if that is unknown.
    AppearanceHistogram appearance;
    /// How much likelier than in a frame without prior a candidate at this place is a person: it multiplies the odds
    /// that the score stands for, in those candidates whose masks are at least kKnownOverlap the expected one (the
    /// pixels in both over those in either) and in the one that started from it. 1 changes nothing, more lets a lower
    /// score suffice, less asks for a higher one. Above 0 and finite.
    float odds = 1.F;
    /// The person's flesh where it is expected, optical frame; empty if that is unknown. With it the detector makes the
    /// mask itself: of the pixels near the flesh that may be a body and are not nearer to somebody else's. With odds
    /// above 1 nobody else grows over them, and a candidate may have any number of parts.
    std::vector<Capsule> flesh = {};
    /// How tall the person is against the body model's adult, if that is known, otherwise 1: the links of the person's
    /// candidates are expected to be so much longer or shorter. Above 0 and finite.
    float size = 1.F;
  };
  std::vector<KnownPerson> people;
};

/// The part of a picture in which people are looked for, where all else is as it was in the last frame that was looked
/// at as a whole.
struct PictureRegion {
  Box box;                         ///< within the picture, not empty
  std::vector<Plane> planes = {};  ///< of that frame, which are not searched for again
};

/// Least overlap of a candidate with the mask of a known person that lets it profit of that person's odds.
inline constexpr float kKnownOverlap = 0.3F;

/// Returns the pixels in both masks over those in either, 0-1; 0 if both are empty.
float shared_pixels(const Mask& a, const Mask& b);

/// Throws Error if a mask and the frame differ in size, or odds or sizes are not above 0 and finite.
void check(const Prior& prior, const Frame& frame);

/// Throws Error if the box is empty or does not lie within the frame.
void check(const PictureRegion& region, const Frame& frame);

/// Returns the prior of the picture inside a box.
Prior cropped(Prior prior, const Box& box);

/// Returns the prior on every `step`-th pixel of every `step`-th row.
Prior every_nth(const Prior& prior, int step);

}  // namespace vesalius
