#pragma once

#include <vector>

#include "metrics/frame_truth.h"
#include "vesalius/detect.h"
#include "vesalius/image.h"
#include "vesalius/trace.h"

namespace vesalius {

/// Smallest mask IoU of a found person with a true one, if each true person's pixels are known.
inline constexpr double kMatchIou = 0.5;
/// The share that is required if only the mask of all people together is known: of a found person's pixels on that
/// mask, or of the mask's pixels on the person. Masks made by subtracting the background lack people who did not move.
inline constexpr double kShareOnMask = 0.5;

/// A person that the detector proposes, whether it accepts it or not.
struct Proposal {
  const Mask* mask = nullptr;
  const Skeleton* skeleton = nullptr;
  float score = 0.F;
};

/// The judgement of a proposal.
struct Match {
  enum class Kind {
    person,   ///< a true person, by the proposal with the highest score
    nobody,   ///< no true person, or one that a proposal with a higher score shows
    ignored,  ///< undecided: the number of people is not known, or too little of this one is visible
  };
  Kind kind = Kind::nobody;
  int person = -1;  ///< index of the true person if pixels are known per person; otherwise a running number
};

/// Smallest visible area, in cm^2, at which a person of a labelled frame is expected to be found: a twelfth of an
/// adult's front. A person with less is neither missed nor false.
inline constexpr double kVisiblePerson_cm2 = 500.0;

/// Sorts the persons of a frame, in masks and lists, such that those who are expected to be found have the indices 0
/// to truth.people - 1. Does nothing if pixels are not known per person.
void put_visible_people_first(TrueFrame& frame);

/// Returns the number of people to be found: the exact one, or 1 if it is only known that there is somebody.
int expected_people(const FrameTruth& truth);

/// Judges proposals, which are sorted by score. If each true person's pixels are known, a proposal is matched with the
/// free person whose mask has the largest IoU with its own, which must be at least kMatchIou. If only the mask of all
/// people is known, kShareOnMask must hold. If only the number of people is known, any place is right. At most as many
/// proposals as there are people are right.
std::vector<Match> match_people(const std::vector<Proposal>& proposals, const FrameTruth& truth,
                                const DepthImage& depth);

/// Returns all people that the detector considered, sorted by score, without those that mostly repeat an earlier one
/// (as RefineOptions::max_overlap says). Curves over score and number of parts are made from them. The result is valid
/// while `trace` is.
std::vector<Proposal> distinct_proposals(const Trace& trace, float max_overlap);

/// Returns the people that the detector accepted as proposals. The result is valid while `people` is.
std::vector<Proposal> accepted_proposals(const std::vector<Person>& people);

}  // namespace vesalius
