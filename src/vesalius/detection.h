#pragma once

#include <cstdint>
#include <vector>

#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/derive_joints.h"
#include "vesalius/find_clusters.h"
#include "vesalius/grow_person.h"
#include "vesalius/score_person.h"
#include "vesalius/search_skeletons.h"

namespace vesalius {

/// Everything found about one person.
struct Person {
  Skeleton skeleton;                       ///< parts with 3-D centre, extent, confidence and state
  std::vector<std::vector<Joint>> joints;  ///< [joint set of the body model][joint]
  Mask mask;                               ///< 1 on the person's pixels
  LabelImage labels;                       ///< part of each of the person's pixels, kBackground elsewhere
  Box box;                                 ///< smallest around the mask
  float score = 0.F;                       ///< 0-1, higher is surer
};

/// What earlier frames tell about the people of a frame; a tracker makes it. Each mask starts a candidate of its own:
/// its pixels are taken for that person's whatever the background says, labelled, searched for a skeleton, grown,
/// refined and scored like any other. So a person is found again whom labels alone would lose; nobody is found who does
/// not score well in this frame. A Prior without people changes nothing.
struct Prior {
  struct KnownPerson {
    /// Non-zero where the person is expected: the mask in the frame before, perhaps moved along. It has the frame's
    /// size, or is empty where nobody knows; then this person starts no candidate.
    Mask mask;
    /// The colours of the person in earlier frames (learn_appearance), to which those of this frame are added before
    /// the mask grows; without samples where nobody knows.
    ColourModel appearance;
  };
  std::vector<KnownPerson> people;
};

/// Throws Error for a mask of another size than the frame's.
void check(const Prior& prior, const Frame& frame);

/// Returns the prior on every `step`-th pixel of every `step`-th row.
Prior every_nth(const Prior& prior, int step);

/// Every intermediate of one detection, for pictures and evaluation. All pictures are of the frame's size; what
/// clusters count are pixels of the grid (GridOptions).
struct Trace {
  LabelImage raw_labels;        ///< pass 1, before smoothing
  LabelImage labels;            ///< pass 1, smoothed
  Clusters clusters;            ///< pass 1, of labels with the proposals' weight of the background
  std::vector<Skeleton> rough;  ///< pass 1, best first
  Mask flat;                    ///< pixels of floor, walls and other large flat surfaces
  /// May be set before: pixels of people, of the frame's size, whose parts are asked for.
  const Mask* person = nullptr;
  LabelImage inside;  ///< parts of those pixels, as the second pass labels them; empty where none were given

  /// A rough skeleton grown and refined. A rough skeleton has two where growing against its rivals differs from growing
  /// alone.
  struct Candidate {
    Skeleton rough;  ///< one of `rough`, or found in the mask of a known person
    int known = -1;  ///< index in Prior::people of the person whose mask it was found in; -1: found without
    Mask grown;
    LabelImage labels;  ///< pass 2, smoothed
    Skeleton refined;   ///< pass 2, or the rough one where that is likelier
    Evidence evidence;
    float score = 0.F;
    bool accepted = false;
  };
  std::vector<Candidate> candidates;  ///< surest first
};

/// Brings what was found on a grid back to the whole picture.
void enlarge(const GridGuide& guide, Person& person);
void enlarge(const GridGuide& guide, Trace& trace);

/// Returns a map of the people of the frame's size: index in `people`, kBackground elsewhere.
Image<std::uint8_t> body_index_map(const std::vector<Person>& people, int width, int height);

/// Returns the part labels of all people in one picture, kBackground elsewhere.
LabelImage part_label_map(const std::vector<Person>& people, int width, int height);

}  // namespace vesalius
