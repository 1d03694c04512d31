#pragma once

#include <vector>

#include "vesalius/base/frame_truth.h"
#include "vesalius/base/image.h"
#include "vesalius/detect.h"

namespace vesalius {

/// Mask IoU from which a found person is a true one where each true person's pixels are known.
inline constexpr double kMatchIou = 0.5;
/// Share of a found person's pixels that must lie on the mask where only that of all people together is known, or of
/// the mask that the person must cover: masks made by taking the background away lack what did not move.
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
/// front. Who shows less is neither missed nor false.
inline constexpr double kVisiblePerson_cm2 = 500.0;

/// For frames whose persons are known apart: gives those who are expected the indices 0 to truth.people - 1, with the
/// others behind, in masks and joints. Leaves other frames alone.
void put_visible_people_first(TrueFrame& frame);

/// Number of people to be found: the exact one, or 1 where it is only known that somebody is there.
int expected_people(const FrameTruth& truth);

/// Judges proposals, surest first. Where each true person's pixels are known, a proposal is that person of whose mask
/// its own has the largest IoU, at least kMatchIou, and who is not taken yet. Where the mask of all is known it must
/// have kShareOnMask of its pixels there or cover as much of it; else it is not looked where it is. At most as many as
/// there are people are right.
std::vector<Match> match_people(const std::vector<Proposal>& proposals, const FrameTruth& truth,
                                const DepthImage& depth);

/// All that the detector considered, surest first, without those that mostly repeat a surer one (as
/// RefineOptions::max_overlap says): what curves over score and number of parts are made from. Valid while `trace` is.
std::vector<Proposal> distinct_proposals(const Trace& trace, float max_overlap);

/// The people that it returned, as proposals. Valid while `people` is.
std::vector<Proposal> accepted_proposals(const std::vector<Person>& people);

}  // namespace vesalius
