#pragma once

#include <vector>

#include "vesalius/base/frame_truth.h"
#include "vesalius/base/image.h"
#include "vesalius/detect.h"

namespace vesalius {

/// Mask IoU from which a found person is a true one where each true person's pixels are known.
inline constexpr double kMatchIou = 0.5;
/// Where only the mask of all people together is known: the share of a found person's pixels that must lie on it, or
/// else the share of it that the person must cover. Masks made by taking the background away lack what did not move.
inline constexpr double kShareOnMask = 0.5;

/// A person that the detector proposes, whether it accepts it or not.
struct Proposal {
  const Mask* mask = nullptr;
  const Skeleton* skeleton = nullptr;
  float score = 0.F;
};

/// What a proposal turned out to be.
struct Match {
  enum class Kind {
    person,   ///< a true person, and the surest proposal of that one
    nobody,   ///< no true person, or one that a surer proposal shows already
    ignored,  ///< cannot be judged: the number of people is not known, or too little of this one is visible
  };
  Kind kind = Kind::nobody;
  int person = -1;  ///< which true one, where persons are known apart; else counts up
};

/// Visible surface from which a person of a labelled frame is expected to be found, cm^2: a twelfth of an adult's
/// front. A person who shows less is neither missed nor false.
inline constexpr double kVisiblePerson_cm2 = 500.0;

/// Sorts the persons of a frame, in masks and joints, so that those who are expected to be found have the indices 0 to
/// truth.people - 1. Leaves frames alone whose persons are not known apart.
void put_visible_people_first(TrueFrame& frame);

/// Returns the number of people to be found: the exact one, or 1 where it is only known that somebody is there.
int expected_people(const FrameTruth& truth);

/// Judges proposals, which come surest first. Where each true person's pixels are known, a proposal is matched with the
/// person not taken yet whose mask has the largest IoU with its own, at least kMatchIou. Where only the mask of all is
/// known, kShareOnMask must hold. Where only the number of people is known, places do not matter. At most as many
/// proposals as there are people are right.
std::vector<Match> match_people(const std::vector<Proposal>& proposals, const FrameTruth& truth,
                                const DepthImage& depth);

/// Returns all that the detector considered, surest first, without those that mostly repeat a surer one (as
/// RefineOptions::max_overlap says). Curves over score and number of parts are made from them. Valid while `trace` is.
std::vector<Proposal> distinct_proposals(const Trace& trace, float max_overlap);

/// Returns the people that the detector accepted as proposals. Valid while `people` is.
std::vector<Proposal> accepted_proposals(const std::vector<Person>& people);

}  // namespace vesalius
