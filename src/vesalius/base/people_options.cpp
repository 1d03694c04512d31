#include "vesalius/people_options.h"

#include "vesalius/base/options.h"

namespace vesalius {
namespace {

void visit_options(const std::string& prefix, BlendOptions& o, OptionVisitor& visitor) {
  visitor.option(
      prefix + "least-share", o.least_share,
      {"", 0.0, 1.0,
       "Readings beside a hole with less than this share of the one on their other side are dropped: resizing "
       "blended them with the hole; 0: none."});
}

void visit_options(const std::string& prefix, GridOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "step", o.step,
                 {"px", 0, 16,
                  "Look at every so many pixels of every so many rows and bring what is found back to all by their "
                  "depth; 0: the least that leaves at most 250,000 pixels, or more where the focal length is long."});
}

void visit_options(const std::string& prefix, LabelOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "background-weight", o.background_weight,
                 {"", 0.0, 100.0, "Factor on the background's posterior; above 1 finds fewer and thinner people."});
  visitor.option(
      prefix + "proposal-weight", o.proposal_weight,
      {"", 0.0, 100.0, "The same where part proposals are looked for: less finds more of what may be people."});
  visitor.option(prefix + "unsure-margin", o.unsure_margin,
                 {"", 0.0, 1.0, "Where the two best labels' probabilities differ by less, neighbours decide."});
  visitor.option(prefix + "gate", o.gate,
                 {"", 0.5, 2.0,
                  "Where the forest, asked at every fourth pixel of every fourth row, gives the background this "
                  "probability all around, it is not asked about pixels between; above 1 it is asked about all."});
}

void visit_options(const std::string& prefix, SmoothOptions& o, OptionVisitor& visitor) {
  visitor.option(
      prefix + "window", o.window,
      {"", 0, 31,
       "Neighbours along a side of the smoothing window, made odd; 1: none, 0: 5 for forests, 3 for networks."});
  visitor.option(prefix + "spacing", o.spacing,
                 {"px", 0, 31, "From one neighbour to the next, 0: about 1/140 of the focal length."});
  visitor.option(prefix + "depth-gate", o.depth_gate_mm,
                 {"mm", 0, 10000, "Neighbours further away than this in depth do not count."});
}

void visit_options(const std::string& prefix, ClusterOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "max-gap", o.max_gap_m,
                 {"m", 0.0, 1.0, "3-D distance that neighbouring pixels of a part may have."});
  visitor.option(prefix + "max-gap-per-z2", o.max_gap_per_z2,
                 {"m per m^2", 0.0, 0.1, "Added to the gap times depth squared: the sensor's depth step."});
  visitor.option(prefix + "min-area", o.min_area_cm2, {"cm^2", 0.0, 10000.0, "Smallest visible area of a part."});
  visitor.option(prefix + "min-pixels", o.min_pixels, {"px", 1, 1000000, "Smallest part at any distance."});
  visitor.option(prefix + "max-extent-scale", o.max_extent_scale,
                 {"", 0.1, 10.0, "Factor on each part's largest feasible length."});
}

void visit_options(const std::string& prefix, SearchOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "max-total-error", o.max_total_error,
                 {"", 0.0, 1000.0, "Largest sum of normalised distances over a person's parts."});
  visitor.option(prefix + "max-mean-error", o.max_mean_error,
                 {"", 0.0, 100.0, "Largest mean normalised distance a part."});
  visitor.option(prefix + "min-parts", o.min_parts, {"", 1, 200, "Fewest parts that make a person."});
  visitor.option(prefix + "max-error", o.max_error,
                 {"", 0.0, 100.0, "Two proposals of a larger normalised distance are not linked."});
  visitor.option(prefix + "error-weight", o.error_weight,
                 {"", 0.0, 100.0, "Likelihood lost by a normalised distance of 1; a full part gains 1."});
  visitor.option(prefix + "covariance-share", o.covariance_share,
                 {"", 0.0, 10.0, "Share of the proposals' own variance that excuses a deviation."});
  visitor.option(prefix + "gap-tolerance", o.gap_tolerance_m,
                 {"m", 0.001, 10.0, "Empty space between linked parts that counts as one unit of error."});
}

void visit_options(const std::string& prefix, PlaneOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "min-area", o.min_area_m2,
                 {"m^2", 0.01, 1000.0, "Smallest flat surface that counts as floor, wall or table."});
  visitor.option(prefix + "thickness", o.thickness_m,
                 {"m", 0.0, 1.0, "Distance from such a surface that still is it."});
  visitor.option(prefix + "thickness-per-z2", o.thickness_per_z2,
                 {"m per m^2", 0.0, 0.1, "Added to the thickness times depth squared: sensor noise."});
}

void visit_options(const std::string& prefix, GrowOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "radius", o.radius_m,
                 {"m", 0.0, 1.0, "3-D distance that neighbouring pixels of a person may have."});
  visitor.option(prefix + "radius-per-z2", o.radius_per_z2,
                 {"m per m^2", 0.0, 0.1, "Added to the radius times depth squared: the sensor's depth step."});
  visitor.option(prefix + "reach", o.reach_m, {"m", 0.0, 3.0, "How far a person extends around a part's centre."});
  visitor.option(prefix + "missing-reach", o.missing_reach_m,
                 {"m", 0.0, 3.0, "Added to the reach of a part next to one that was not seen."});
  visitor.option(prefix + "appearance", o.appearance,
                 {"", 0, 0,
                  "What a pixel looks like: its hue, hue and texture, or none where colour is badly registered (hue, "
                  "texture, none)."});
  visitor.option(prefix + "own-look", o.own_look_m,
                 {"m", 0.0, 3.0, "This near to a part's centre any look is the person's."});
  visitor.option(
      prefix + "least-body", o.least_body,
      {"", 0.0, 1.0,
       "A person does not grow over pixels that the forest takes for body with less than this probability."});
  visit_options(prefix + "plane-", o.plane, visitor);
}

void visit_options(const std::string& prefix, RefineOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "second-pass", o.second_pass,
                 {"", 0, 1, "Whether each person is labelled and searched again."});
  visitor.option(prefix + "max-candidates", o.max_candidates,
                 {"", 1, 1000, "Most rough skeletons refined in one frame."});
  visitor.option(prefix + "min-parts", o.min_parts, {"", 1, 200, "Fewest parts of a person after the second pass."});
  visitor.option(prefix + "min-score", o.min_score, {"", 0.0, 1.0, "Lowest score of a person."});
  visitor.option(prefix + "max-overlap", o.max_overlap,
                 {"", 0.0, 1.0, "Share of its mask that a person may have in common with a surer one."});
}

}  // namespace

void visit_options(const std::string& prefix, DetectOptions& o, OptionVisitor& visitor) {
  visit_options(prefix + "blend.", o.blend, visitor);
  visit_options(prefix + "grid.", o.grid, visitor);
  visit_options(prefix + "label.", o.label, visitor);
  visit_options(prefix + "smooth.", o.smooth, visitor);
  visit_options(prefix + "cluster.", o.cluster, visitor);
  visit_options(prefix + "search.", o.search, visitor);
  visit_options(prefix + "grow.", o.grow, visitor);
  visit_options(prefix + "refine.", o.refine, visitor);
}

void visit_options(const std::string& prefix, TrackOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "rate", o.rate, {"1/s", 0.01, 10000.0, "Frames a second of a source without times."});
  visitor.option(prefix + "confirm", o.confirm,
                 {"", 1, 1000, "Frames in which somebody must be found to be more than a guess."});
  visitor.option(prefix + "confirm-within", o.confirm_s,
                 {"s", 0.0, 60.0, "Longest time from one of these to the next."});
  visitor.option(prefix + "hidden", o.hidden_s, {"s", 0.0, 3600.0, "Time after which somebody not found is lost."});
  visitor.option(prefix + "down", o.down_s,
                 {"s", 0.0, 3600.0, "The same for somebody near the floor, as long as something is still there."});
  visitor.option(prefix + "gap", o.gap_s, {"s", 0.0, 3600.0, "A longer step in time loses everybody."});
  visitor.option(prefix + "remembered", o.remembered, {"", 0, 10000, "Most lost people who are known again."});
  visitor.option(prefix + "same-look", o.same_look,
                 {"", 0.0, 10.0, "Greatest difference of looks of somebody who comes back."});
  visitor.option(prefix + "odds", o.odds,
                 {"", 1.0, 1000.0, "Most by which having been found multiplies the odds of being found again."});
  visitor.option(prefix + "whole", o.whole_s,
                 {"s", 0.0, 60.0, "Time between looks at the whole picture; 0 always looks at all of it."});
  visitor.option(prefix + "smooth", o.smooth, {"", 0, 1, "Whether joints are smoothed over time as well."});
  visitor.option(prefix + "smooth-cutoff", o.smoothing.cutoff_hz,
                 {"Hz", 0.01, 1000.0, "Cutoff of the smoothing of joints at rest."});
  visitor.option(prefix + "smooth-speed", o.smoothing.cutoff_per_m_s,
                 {"Hz per m/s", 0.0, 1000.0, "Added to the cutoff times a joint's speed."});
}

void visit_options(const std::string& prefix, FitOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "iterations", o.iterations, {"", 1, 200, "Most steps to the parts' centres."});
  visitor.option(prefix + "rounds", o.rounds, {"", 1, 200, "Most assignments of points to bones."});
  visitor.option(prefix + "surface", o.surface_m, {"m", 0.001, 1.0, "Standard deviation of points about the flesh."});
  visitor.option(prefix + "outline", o.outline_m, {"m", 0.001, 1.0, "Standard deviation of flesh off the outline."});
  visitor.option(prefix + "free", o.free_m, {"m", 0.001, 1.0, "Standard deviation of flesh in free space."});
  visitor.option(prefix + "outline-weight", o.outline_weight, {"", 0.0, 100.0, "Weight of outline and free space."});
  visitor.option(prefix + "pose-weight", o.pose_weight, {"", 0.0, 100.0, "Weight of how usual the pose is."});
  visitor.option(prefix + "shape-weight", o.shape_weight, {"", 0.0, 100.0, "Weight of how usual the shape is."});
  visitor.option(prefix + "follow", o.follow_m,
                 {"m", 0.001, 10.0, "Standard deviation of a person's place from the expected one in 1/30 s."});
  visitor.option(prefix + "ground", o.ground_m,
                 {"m", 0.001, 10.0, "Standard deviation of flesh below the ground, and of the lowest foot above it."});
  visitor.option(prefix + "walk-cost", o.walk_cost,
                 {"", 0.0, 10000.0, "Squared deviations that a body costs which walks backwards."});
}

void visit_options(const std::string& prefix, PeopleOptions& options, OptionVisitor& visitor) {
  visit_options(prefix, options.detect, visitor);
  visit_options(prefix + "track.", options.track, visitor);
  visit_options(prefix + "fit.", options.fit, visitor);
}

}  // namespace vesalius
