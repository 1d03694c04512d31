#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vesalius/base/blended_depth.h"
#include "vesalius/base/capsule.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/derive_joints.h"
#include "vesalius/find_clusters.h"
#include "vesalius/forest/facing.h"
#include "vesalius/forest/person_points.h"
#include "vesalius/grow_person.h"
#include "vesalius/planes/find_planes.h"
#include "vesalius/score_person.h"
#include "vesalius/search_skeletons.h"

namespace vesalius {

/// Everything that was found about one person.
struct Person {
  Skeleton skeleton;                       ///< parts with 3-D centre, extent, confidence and state
  std::vector<std::vector<Joint>> joints;  ///< [joint set of the body model][joint]
  Mask mask;                               ///< 1 on the person's pixels
  LabelImage labels;                       ///< part of each of the person's pixels, kBackground elsewhere
  Box box;                                 ///< smallest box around the mask
  float score = 0.F;                       ///< 0-1, higher is more certain; what this frame alone tells
  std::optional<YawEstimate> yaw;          ///< which way the person faces, if the forest's leaves have headings
  std::vector<PersonPoint> points;         ///< some of the person's pixels with the likeliest parts of each
};

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

/// Least overlap of a candidate with the mask of a known person that lets it profit of that person's odds.
inline constexpr float kKnownOverlap = 0.3F;

/// Returns the pixels in both masks over those in either, 0-1; 0 if both are empty.
float shared_pixels(const Mask& a, const Mask& b);

/// Throws Error if a mask and the frame differ in size, or odds or sizes are not above 0 and finite.
void check(const Prior& prior, const Frame& frame);

/// Returns the prior on every `step`-th pixel of every `step`-th row.
Prior every_nth(const Prior& prior, int step);

/// The people of a frame and the large flat surfaces about them.
struct Detection {
  std::vector<Person> people;  ///< the most certain first
  std::vector<Plane> planes;   ///< floor, walls and others, largest first (find_planes)
};

/// Every intermediate result of one detection, for pictures and evaluation. All pictures have the frame's size;
/// clusters count pixels of the grid (GridOptions).
struct Trace {
  LabelImage raw_labels;        ///< pass 1, before smoothing
  LabelImage labels;            ///< pass 1, smoothed
  Clusters clusters;            ///< pass 1, of labels with the proposals' weight of the background
  std::vector<Skeleton> rough;  ///< pass 1, best first
  Mask flat;                    ///< pixels of floor, walls and other large flat surfaces
  /// Input: if it is set before detection, `inside` is filled for its non-zero pixels. Those of one person have the
  /// same number. It has the frame's size.
  const Mask* person = nullptr;
  LabelImage inside;  ///< the second pass's labels of those pixels; empty if none were given

  /// A grown and refined rough skeleton. A rough skeleton has two candidates if growing against its rivals gives
  /// another mask than growing alone.
  struct Candidate {
    Skeleton rough;  ///< one of `rough`, or the one found in the mask of a known person
    int known = -1;  ///< index in Prior::people of the person for whom it is taken, or -1
    Mask grown;
    LabelImage labels;  ///< pass 2, smoothed
    std::vector<PersonPoint> points;
    Skeleton refined;  ///< pass 2, or the rough one if that is likelier
    Evidence evidence;
    float score = 0.F;
    float certainty = 0.F;  ///< `score` with the odds of the known person whom it covers; the same without one
    std::optional<YawEstimate> yaw;
    bool accepted = false;
  };
  std::vector<Candidate> candidates;  ///< most certain first
};

/// Transfers a person found on a grid to the whole picture.
void enlarge(const GridGuide& guide, Person& person);
void enlarge(const GridGuide& guide, Trace& trace);

/// Returns a map of the people of the frame's size: index in `people`, kBackground elsewhere. People whose masks are
/// empty have no pixels.
Image<std::uint8_t> body_index_map(const std::vector<Person>& people, int width, int height);

/// Returns the part labels of all people in one picture, kBackground elsewhere. People whose masks are empty have none.
LabelImage part_label_map(const std::vector<Person>& people, int width, int height);

}  // namespace vesalius
