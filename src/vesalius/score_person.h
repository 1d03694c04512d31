#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/forest/person_points.h"
#include "vesalius/frame.h"
#include "vesalius/group_votes.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"
#include "vesalius/person.h"

namespace vesalius {

inline constexpr float kUsualArea_m2 = 0.45F;  ///< usual area of a person's mask: a standing adult's front
inline constexpr float kBendReach_m = 0.15F;   ///< a limb's radius and more
inline constexpr float kAgreed_m = 0.2F;       ///< votes this near to their group's middle agree on it

/// The evidence that a grown mask and its skeleton are a person. Numbers without a unit are 0-1.
struct Evidence {
  float likelihood = 0.F;  ///< accumulated likelihood of the skeleton over the number of the body's parts
  float explained = 0.F;   ///< share of the mask whose label's part, or its mirror partner, was found nearby
  float open = 0.F;        ///< share of the free outline (not occluded or cut off) with nothing close behind
  float core = 0.F;        ///< share found of the search's roots and the parts next to them
  float body = 0.F;        ///< mean over the mask of the parts' share of the posterior
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
  // What groups of votes tell (group_votes.h). All but the last are 0 for candidates without one.
  float votes = 0.F;              ///< log10 of the group's number of votes
  float spread_m = 0.F;           ///< root mean square distance of its votes to their mean
  float likely = 0.F;             ///< log odds of its mean body share
  float agree = 0.F;              ///< share of the mask's votes within kAgreed_m of its middle
  float heading = 0.F;            ///< confidence of its heading
  float sided = 0.F;              ///< agreement_of_sides of the skeleton and its heading
  float groups = 0.F;             ///< Scenery::groups
  std::vector<float> parts = {};  ///< share of each part and its mirror partner in the mask's body (part_slots)
};

/// What a picture has besides a candidate.
struct Scenery {
  const Mask& flat;            ///< 1 on floor, walls and other large flat surfaces
  float body_elsewhere = 0.F;  ///< mean body share of the posterior outside of all candidates' masks
  int proposals = 0;           ///< rough skeletons of the first pass
  int groups = 0;              ///< groups of votes
};

/// A kind of evidence that a judge may ask for.
struct JudgedEvidence {
  std::string_view name;  ///< in model files
  float Evidence::*evidence;
  int sign = 0;  ///< 1 if more of it can only speak for a person, -1 if only against, 0 if that is open
};
inline constexpr std::array<JudgedEvidence, 22> kJudgedEvidence{{{"likelihood", &Evidence::likelihood, 1},
                                                                 {"explained", &Evidence::explained, 1},
                                                                 {"open", &Evidence::open, 1},
                                                                 {"core", &Evidence::core, 1},
                                                                 {"body", &Evidence::body, 1},
                                                                 {"size", &Evidence::size, 1},
                                                                 {"occluded", &Evidence::occluded},
                                                                 {"near", &Evidence::near},
                                                                 {"certain", &Evidence::certain, 1},
                                                                 {"border", &Evidence::border},
                                                                 {"beside", &Evidence::beside, -1},
                                                                 {"resolution", &Evidence::resolution},
                                                                 {"surest", &Evidence::surest, 1},
                                                                 {"facing", &Evidence::facing, 1},
                                                                 {"depth", &Evidence::depth_m},
                                                                 {"length", &Evidence::length_m},
                                                                 {"slant", &Evidence::slant},
                                                                 {"bend", &Evidence::bend_m},
                                                                 {"ragged", &Evidence::ragged},
                                                                 {"on_flat", &Evidence::on_flat},
                                                                 {"elsewhere", &Evidence::elsewhere},
                                                                 {"rivals", &Evidence::rivals}}};
/// What groups of votes tell; all 0 where labellers have no votes.
inline constexpr std::array<JudgedEvidence, 7> kVotedEvidence{{{"votes", &Evidence::votes},
                                                               {"spread", &Evidence::spread_m, -1},
                                                               {"likely", &Evidence::likely, 1},
                                                               {"agree", &Evidence::agree, 1},
                                                               {"heading", &Evidence::heading},
                                                               {"sided", &Evidence::sided},
                                                               {"groups", &Evidence::groups}}};

/// Returns the names of all evidence of a body: kJudgedEvidence, "part:" and the name of each kind of part, and
/// kVotedEvidence.
std::vector<std::string> judge_names(const BodyModel& body);

/// Returns the sign of each.
std::vector<int> judge_signs(const BodyModel& body);

/// Returns the value of each.
std::vector<float> judge_features(const Evidence& evidence);

/// Measures the evidence that a mask and a skeleton are a person. `labels` are those inside `mask`, `posteriors` those
/// of the first pass; all have the frame's size, and so has the scenery.
Evidence gather_evidence(const Frame& frame, const Mask& mask, const PersonLabels& labels, const Posteriors& posteriors,
                         const Scenery& scenery, const Skeleton& skeleton, const BodyModel& body);

/// Adds what a candidate's group of votes tells of its mask and skeleton. All pictures have the frame's size.
void add_votes(const Frame& frame, const Mask& mask, const Image<PersonVote>& votes, const VoteGroup& group,
               const Skeleton& skeleton, const BodyModel& body, Evidence& evidence);

/// Returns the cosine between the heading of a skeleton's observed parts (body_yaw) and a given one: above 0 where left
/// and right agree. Returns 0 where the parts have no heading.
float agreement_of_sides(const Skeleton& skeleton, const YawEstimate& heading, const BodyModel& body);

/// Returns Scenery::body_elsewhere for the union of the candidates' masks, from every second pixel of every second row.
float mean_body_outside(const Mask& candidates, const DepthImage& depth, const Posteriors& posteriors, int parts);

}  // namespace vesalius
