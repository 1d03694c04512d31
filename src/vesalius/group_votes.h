#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"
#include "vesalius/person.h"

namespace vesalius {

/// Votes for one middle: most likely one person's.
struct VoteGroup {
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();  ///< where the votes are densest, metres, optical frame
  int votes = 0;
  float spread_m = 0.F;  ///< root mean square distance of the votes to their mean
  float body = 0.F;      ///< mean body share of the pixels that vote, 0.5-1
  YawEstimate heading;   ///< mean of the votes'; its length, 0-1, is the confidence
  Box box = {};          ///< around its pixels
};

/// The groups of a frame's votes, and whose every pixel is.
struct VoteGroups {
  std::vector<VoteGroup> items;  ///< the most massive first, at most kMostGroups
  Image<std::uint8_t> index;     ///< index of each body pixel's group, kBackground elsewhere; empty without groups
};
inline constexpr int kMostGroups = 12;

/// Returns the point for which the pixel of vote (column, row) votes, metres, optical frame. It has a reading.
Eigen::Vector3f voted_middle(const Image<PersonVote>& votes, const Frame& frame, int column, int row);

/// Groups the votes of the pixels that are likelier body than not by mean shift. Every vote within 60 cm of a peak
/// belongs to the nearest one, and every body pixel to the group of the nearest vote from which body pixels of like
/// depth lead to it. `parts` is the number of the body's; there are no groups without votes.
VoteGroups group_votes(const Posteriors& posteriors, const Frame& frame, int parts);

/// Returns the index of the group that has the most pixels of a mask of the frame's size, or -1 if none has a third.
int main_group(const VoteGroups& groups, const Mask& mask);

}  // namespace vesalius
