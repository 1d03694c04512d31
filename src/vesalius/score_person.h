#pragma once

#include <array>
#include <string>
#include <vector>

#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"
#include "vesalius/base/options.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/person_labels.h"
#include "vesalius/search_skeletons.h"

namespace vesalius {

struct ScoreOptions {
  float likelihood_weight = 2.03F;   ///< of the skeleton's likelihood, as a share of all parts' (0-1)
  float explained_weight = 0.F;      ///< of the share of the mask that the skeleton explains
  float open_weight = 0.F;           ///< of the share of the outline that stands free
  float core_weight = 0.24F;         ///< of the share of head, neck and chest parts found
  float body_weight = 11.95F;        ///< of how sure the forest is that the mask is body
  float size_weight = 0.58F;         ///< of how near the mask's area is to a person's
  float occluded_weight = 3.67F;     ///< of the share of the outline that something nearer cuts off
  float near_weight = -3.43F;        ///< of how near the camera it is
  float certain_weight = 2.51F;      ///< of how sure the forest is which part each pixel is
  float border_weight = 2.58F;       ///< of the share of the outline that the picture's border cuts off
  float beside_weight = -0.79F;      ///< of how much body the forest sees beside the mask
  float resolution_weight = 11.41F;  ///< of the number of pixels
  float bias = -16.81F;
};
void visit_options(const std::string& prefix, ScoreOptions& options, OptionVisitor& visitor);

/// Returns the defaults for forests without background class, fitted with the paper's released trees. Cut-out furniture
/// looks like a body to them, so the outline matters more.
ScoreOptions score_without_background();

inline constexpr float kUsualArea_m2 = 0.45F;  ///< of a person's mask: a standing adult's front
inline constexpr float kBendReach_m = 0.15F;   ///< a limb's radius and more

/// The evidence that a grown mask and its skeleton are a person. Numbers without a unit are 0-1.
struct Evidence {
  float likelihood = 0.F;  ///< accumulated likelihood of the skeleton over the number of the body's parts
  float explained = 0.F;   ///< share of the mask whose label's part, or its mirror partner, was found nearby
  float open = 0.F;        ///< share of the free outline (not occluded or cut off) with nothing close behind
  float core = 0.F;        ///< share found of the search's roots and the parts next to them
  float body = 0.F;        ///< mean over the mask of the parts' share of the posterior; 1 without background class
  float size = 0.F;        ///< ratio of the mask's area and kUsualArea_m2, or its inverse if that is smaller
  float occluded = 0.F;    ///< share of the outline beside something nearer, which excuses missing parts
  float near = 0.F;        ///< one metre divided by the mean depth, at most 1, since distant people are less certain
  float certain = 0.F;     ///< PersonLabels::certain: furniture looks like several parts
  float border = 0.F;      ///< share of the outline at the picture's border
  float beside = 0.F;      ///< mean body share of pixels a few pixels beside the mask: around noise it is high as well
  float resolution = 0.F;  ///< log10 of the mask's number of pixels, over 5
  float surest = 0.F;      ///< body share that a tenth of the mask's pixels exceed
  float facing = 0.F;      ///< probability of the likeliest heading; 0 where the forest's leaves have none
  float depth_m = 0.F;     ///< standard deviation of the mask's points along their shortest principal axis
  float length_m = 0.F;    ///< the same along their longest
  float slant = 0.F;       ///< |cosine| of the angle between the shortest axis and the viewing direction
  float bend_m = 0.F;      ///< mean distance of a point from the middle of those kBendReach_m to both sides of it
  float ragged = 0.F;      ///< sides of pixels along the outline over the square root of the mask's pixels
  float on_flat = 0.F;     ///< pixels close to floor, wall or table over the square root of the mask's pixels
  float elsewhere = 0.F;   ///< Scenery::body_elsewhere: in some pictures the forest sees bodies everywhere
  float rivals = 0.F;      ///< Scenery::proposals: clutter gives many at once
  std::vector<float> parts = {};  ///< share of each part and its mirror partner in the mask's body (part_slots)
};

/// What a picture has besides a candidate.
struct Scenery {
  const Mask& flat;            ///< 1 on floor, walls and other large flat surfaces
  float body_elsewhere = 0.F;  ///< mean body share of the posterior outside of all candidates' masks
  int proposals = 0;           ///< rough skeletons of the first pass
};

/// A kind of evidence and the option with its weight.
struct EvidenceWeight {
  float Evidence::*evidence;
  float ScoreOptions::*weight;
  int sign = 0;  ///< 1 if more of it can only speak for a person, -1 if only against, 0 if that is open
};
inline constexpr std::array<EvidenceWeight, 12> kEvidenceWeights{
    {{&Evidence::likelihood, &ScoreOptions::likelihood_weight, 1},
     {&Evidence::explained, &ScoreOptions::explained_weight, 1},
     {&Evidence::open, &ScoreOptions::open_weight, 1},
     {&Evidence::core, &ScoreOptions::core_weight, 1},
     {&Evidence::body, &ScoreOptions::body_weight, 1},
     {&Evidence::size, &ScoreOptions::size_weight, 1},
     {&Evidence::occluded, &ScoreOptions::occluded_weight},
     {&Evidence::near, &ScoreOptions::near_weight},
     {&Evidence::certain, &ScoreOptions::certain_weight, 1},
     {&Evidence::border, &ScoreOptions::border_weight},
     {&Evidence::beside, &ScoreOptions::beside_weight, -1},
     {&Evidence::resolution, &ScoreOptions::resolution_weight}}};

/// A kind of evidence that a BoostedTrees is given.
struct JudgedEvidence {
  float Evidence::*evidence;
  int sign = 0;  ///< as EvidenceWeight's
};
inline constexpr std::array<JudgedEvidence, 22> kJudgedEvidence{
    {{&Evidence::likelihood, 1}, {&Evidence::explained, 1}, {&Evidence::open, 1},    {&Evidence::core, 1},
     {&Evidence::body, 1},       {&Evidence::size, 1},      {&Evidence::occluded},   {&Evidence::near},
     {&Evidence::certain, 1},    {&Evidence::border},       {&Evidence::beside, -1}, {&Evidence::resolution},
     {&Evidence::surest, 1},     {&Evidence::facing, 1},    {&Evidence::depth_m},    {&Evidence::length_m},
     {&Evidence::slant},         {&Evidence::bend_m},       {&Evidence::ragged},     {&Evidence::on_flat},
     {&Evidence::elsewhere},     {&Evidence::rivals}}};

/// Returns the sign of each of judge_features (EvidenceWeight).
std::vector<int> judge_signs(const BodyModel& body);

/// Returns what a BoostedTrees is asked: kJudgedEvidence, then the parts.
std::vector<float> judge_features(const Evidence& evidence);

/// Measures the evidence that a mask and a skeleton are a person. `labels` are those inside `mask`, `posteriors` those
/// of the first pass; all have the frame's size, and so has the scenery.
Evidence gather_evidence(const Frame& frame, const Mask& mask, const PersonLabels& labels, const Posteriors& posteriors,
                         const Scenery& scenery, const Skeleton& skeleton, const BodyModel& body);

/// Returns Scenery::body_elsewhere for the union of the candidates' masks, from every second pixel of every second row.
/// It is 0 for a forest without background class.
float mean_body_outside(const Mask& candidates, const DepthImage& depth, const Posteriors& posteriors, int parts);

/// Returns the score of a person, 0-1, by a logistic function whose weights were fitted to frames with and without
/// people. It is for forests without a BoostedTrees.
float person_score(const Evidence& evidence, const ScoreOptions& options);

}  // namespace vesalius
