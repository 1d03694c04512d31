#pragma once

#include <optional>
#include <vector>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/find_clusters.h"
#include "vesalius/image.h"
#include "vesalius/person.h"
#include "vesalius/score_person.h"

namespace vesalius {

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

  /// A grown and refined group of votes or rough skeleton. A rough skeleton has two candidates if growing against its
  /// rivals gives another mask than growing alone.
  struct Candidate {
    Skeleton rough;          ///< one of `rough`, or the one found in a group or in the mask of a known person
    int group = -1;          ///< index of the group of votes (VoteGroups) from which it comes or that it shows, or -1
    int known = -1;          ///< index in Prior::people of the person for whom it is taken, or -1
    bool elsewhere = false;  ///< whether that person was expected elsewhere, and is known by votes
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

}  // namespace vesalius
