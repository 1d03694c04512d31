#pragma once

// Estimates how long growing will take from a small tree that is grown first.
//
// A pilot of S' samples out of whole frames grows trees that look at split_pixels x S'/S samples where a node chooses
// its split, S being the samples of the real run. Its tree then stands for the upper part of a real one: a pilot node
// of n' samples for a real one of n' S/S'. Below it, each leaf of several classes goes on until its samples are as few
// as the pilot's, for k log2(S/S') levels, though not deeper than `depth`; k is how many levels the pilot itself took
// to halve a node. So
//   evaluations = candidates x S/S' x (sum over inner nodes of min(n', split_pixels S'/S)
//                                      + sum over mixed leaves of n' x min(k log2(S/S'), depth - level))
// scaled by what the first sum says of the pilot beside what it did. The rate is the pilot's: grow_tree reads frames in
// order once a level, so it matters that the pilot's frames outgrow the caches, not that they are as many as the run's.
// Trainings on 1000, 2000, 4000, 6000 and 8000 frames of 320x240 (synthetic, depth 20, 50 candidates) made 3 to 7 %
// more or less evaluations than this says.

#include <cstdint>
#include <vector>

#include "train/grow_forest.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"

namespace vesalius {

/// The time and work of growing a forest.
struct GrowthEstimate {
  double evaluations = 0.0;        ///< values of eq. 1 for all trees of both rounds
  double evaluations_per_s = 0.0;  ///< rate of all allowed threads together
  double hard_search_s = 0.0;      ///< time of the search for hard negatives
  double seconds() const { return evaluations / evaluations_per_s + hard_search_s; }
};

/// Grows a pilot for some seconds on `frames`, repeated where they are few, and returns what `samples` of such frames
/// would take, with `trees_at_once` trees at a time. Throws Error as TrainingSet::add and grow_tree do.
GrowthEstimate estimate_growth(const std::vector<LabelledFrame>& frames, const BodyModel& body, std::uint64_t samples,
                               const TrainOptions& options, int trees_at_once);

}  // namespace vesalius
