#pragma once

// What can be turned: the options of finding people, of following them and of fitting bodies to them. docs/options.md
// has their ranges and what they do.

#include <string>

namespace vesalius {

class OptionVisitor;

/// Readings beside holes, which resizing blends with them.
struct BlendOptions {
  float least_share = 0.95F;  ///< share of the reading behind it that a reading beside a hole needs; 0: all are kept
};

/// Options of the grid of pixels at which the method looks.
struct GridOptions {
  /// Columns and rows from one pixel of the grid to the next; 0 takes the smallest step that leaves at most 250,000
  /// pixels.
  int step = 0;
};

/// How labels follow from the posteriors of pixels (section 4).
struct LabelOptions {
  float background_weight = 0.5F;  ///< multiplies the background's posterior, which corrects its prior
  float proposal_weight = 0.35F;   ///< the factor used instead for part proposals
  float unsure_margin = 0.05F;     ///< difference in probability below which neighbours decide
  /// If the background's probability is at least this at every fourth pixel of every fourth row around a pixel, and
  /// depth is continuous, the forest is not asked about the pixel. Above 1 it is asked about every pixel.
  float gate = 0.7F;
};

/// How posteriors are smoothed (section 4.2.1).
struct SmoothOptions {
  /// Neighbours along a side of the square; an even number counts as the next odd one; 1 = none; 0: what suits the
  /// labeller (Labeller::smoothing_window), 5 where it does not say.
  int window = 0;
  int spacing = 0;  ///< pixels from one neighbour to the next when smoothing posteriors; 0: 1/140 of the focal length
  int depth_gate_mm = 60;  ///< posteriors of neighbours further away than this in depth do not count
};

/// Part proposals (section 5).
struct ClusterOptions {
  float max_gap_m = 0.05F;        ///< 3-D distance that neighbouring pixels may have
  float max_gap_per_z2 = 0.003F;  ///< added per square metre of depth: a structured-light sensor's depth step
  float min_area_cm2 = 20.F;      ///< smallest visible area of a part
  int min_pixels = 20;            ///< smallest cluster at any distance
  float max_extent_scale = 1.F;   ///< multiplies each part's largest feasible length
};

/// Links of proposals that make people (section 6).
struct SearchOptions {
  float max_total_error = 12.F;    ///< largest sum of normalised distances over the parts
  float max_mean_error = 0.6F;     ///< largest mean normalised distance of the parts
  int min_parts = 4;               ///< fewest parts of a person (the paper's threshold)
  float max_error = 1.2F;          ///< pairs of a larger normalised distance are not consistent
  float error_weight = 1.F;        ///< likelihood that a normalised distance of 1 costs; a full part gains 1
  float covariance_share = 0.25F;  ///< share of the parts' own variance along their line that excuses a deviation
  float gap_tolerance_m = 0.08F;   ///< empty space between two linked parts that counts as one unit of error
  bool grandparents = true;        ///< whether an unseen part may be skipped (two degrees of separation); for ablations
  bool any_root = true;  ///< whether a tree may start from any part, or only from the body's roots; for ablations
};

/// Large flat surfaces that are nobody: floor, walls, tables.
struct PlaneOptions {
  float min_area_m2 = 1.F;          ///< smallest surface that counts: no person shows this much flat
  float thickness_m = 0.02F;        ///< distance from the plane that still belongs to it
  float thickness_per_z2 = 0.003F;  ///< added per square metre of depth: sensor noise
};

/// Growing from a skeleton to all pixels of a person (section 7).
struct GrowOptions {
  float radius_m = 0.05F;          ///< 3-D distance that neighbouring pixels of a person may have
  float radius_per_z2 = 0.003F;    ///< added per square metre of depth: a structured-light sensor's depth step
  float reach_m = 0.3F;            ///< how far a person extends around the centre of a part
  float missing_reach_m = 0.2F;    ///< added once for each unseen part beyond
  std::string appearance = "hue";  ///< make_appearance
  float own_look_m = 0.12F;        ///< any look this near to a part's centre is the person's
  float least_body = 0.25F;        ///< least body share of the posterior of pixels that a person grows over
  PlaneOptions plane;
};

/// Second iteration and acceptance (section 7).
struct RefineOptions {
  bool second_pass = true;   ///< if false, the rough skeleton and its grown mask are the result
  int max_candidates = 12;   ///< most rough skeletons refined in one frame
  int min_parts = 6;         ///< fewest parts of a person after the second pass
  float min_score = 0.8F;    ///< lowest score of a person: a false one costs four missed ones
  float max_overlap = 0.3F;  ///< share of the mask that a person may have in common with a more certain one
};

/// The options of a Detector.
struct DetectOptions {
  BlendOptions blend;
  GridOptions grid;
  LabelOptions label;
  SmoothOptions smooth;
  ClusterOptions cluster;
  SearchOptions search;
  GrowOptions grow;
  RefineOptions refine;
};
void visit_options(const std::string& prefix, DetectOptions& options, OptionVisitor& visitor);

/// The One-Euro filter of joints over time.
struct JointSmoothing {
  float cutoff_hz = 2.F;       ///< cutoff for a joint at rest: only slower changes pass
  float cutoff_per_m_s = 6.F;  ///< rise of the cutoff with the joint's speed, in hertz for a metre a second
};

/// The options of a PeopleTracker.
struct TrackOptions {
  float rate = 30.F;       ///< frames a second of sources without times
  int confirm = 3;         ///< frames in which somebody must be found to be more than a guess ...
  float confirm_s = 1.F;   ///< ... with at most this much time from one to the next
  float hidden_s = 3.F;    ///< time after which somebody who is not found is lost
  float down_s = 30.F;     ///< the same of somebody near the floor, as long as something is there
  float gap_s = 5.F;       ///< a longer step in time, or one backwards, loses everybody
  int remembered = 32;     ///< most lost people who are known again
  float same_look = 0.1F;  ///< most difference of looks (look_distance) of one person who comes back
  float odds = 40.F;       ///< most by which having been found before multiplies the odds of being found again
  /// Time after which the whole picture is looked at again; between, only where people are, as long as nothing else
  /// moves.
  float whole_s = 0.17F;
  bool smooth = true;  ///< whether TrackedPerson::smoothed is filled
  JointSmoothing smoothing;
};
void visit_options(const std::string& prefix, TrackOptions& options, OptionVisitor& visitor);

/// How bodies with bones and flesh are fitted to people.
struct FitOptions {
  int iterations = 8;           ///< most steps to the parts' centres, from which a fit starts
  int rounds = 3;               ///< most times that points are assigned to bones, with three steps after each
  float surface_m = 0.025F;     ///< standard deviation of points about the flesh's surface
  float outline_m = 0.06F;      ///< standard deviation of flesh beyond the outline
  float free_m = 0.06F;         ///< standard deviation of flesh in space that the camera sees is free
  float outline_weight = 0.3F;  ///< weight of those two, for each of three places of a bone
  float pose_weight = 0.5F;     ///< weight of the poses' distribution
  float shape_weight = 1.F;     ///< weight of the bodies' distribution
  float follow_m = 0.02F;       ///< standard deviation of the root from its expected place after a thirtieth second
  float ground_m = 0.05F;       ///< standard deviation of flesh below the ground, and of the lowest foot above it
  float walk_cost = 200.F;      ///< squared deviations that walking backwards costs
};
void visit_options(const std::string& prefix, FitOptions& options, OptionVisitor& visitor);

/// The options of all that is done to find people, to follow them and to fit bodies to them.
struct PeopleOptions {
  DetectOptions detect;
  TrackOptions track;
  FitOptions fit;
};
/// Shows the detector's options under their own names, the others as `track.*` and `fit.*`.
void visit_options(const std::string& prefix, PeopleOptions& options, OptionVisitor& visitor);

}  // namespace vesalius
