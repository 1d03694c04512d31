#pragma once

// People as they are found in a frame, as bodies are fitted to them, and as they are followed over frames.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// Why a joint or part is not observed.
enum class Unseen {
  none,              ///< it is observed
  out_of_picture,    ///< it would be beyond the picture, or in a border of it that has no readings
  behind_person,     ///< somebody's pixels are nearer, also the person's own: one side of the body hides the other
  behind_something,  ///< something else is nearer
  no_depth,          ///< the camera has no readings where it would be
  not_sure           ///< nothing covers its place, or nobody knows the place: it may be elsewhere, or not be recognised
};
const char* to_string(Unseen unseen);

/// One part of a found person.
struct SkeletonPart {
  State state = State::none;
  int cluster = -1;                                    ///< index of its proposal; -1 unless observed
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();    ///< metres, optical frame
  Eigen::Vector3f extent_m = Eigen::Vector3f::Zero();  ///< standard deviations along its own axes, largest first
  float error = 0.F;       ///< normalised distance to the part to which it is linked; 0 for the root
  float confidence = 0.F;  ///< 0-1
  Unseen unseen = Unseen::none;
  int behind = -1;  ///< as Joint::behind
};

/// Where the pixels of a person say that a part is, whether it is seen or hidden.
struct VotedPart {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< of the part's volume, metres, optical frame
  float spread_m = 0.F;  ///< median distance of the votes to it, along the axis where that is largest
};

/// A kinematic tree over part proposals (section 6).
struct Skeleton {
  std::vector<SkeletonPart> parts;  ///< one for each part of the body model
  std::vector<VotedPart> voted;     ///< one for each part, or none: the labeller does not know
  int root = -1;                    ///< index of its root
  int found = 0;                    ///< number of observed parts
  float total_error = 0.F;          ///< sum of |normalised distance| over the parts
  float mean_error = 0.F;           ///< total_error / found
  float score = 0.F;                ///< accumulated likelihood; ranks people
};

/// A joint of one of the body model's joint sets.
struct Joint {
  State state = State::none;
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< metres, optical frame; NaN where state is none
  float confidence = 0.F;                              ///< 0-1
  Unseen unseen = Unseen::none;
  /// Whose pixels hide it, where unseen is behind_person: an index in the frame's list of people, the person's own
  /// where it is behind the own body; -1 otherwise.
  int behind = -1;
};

/// Which way a person faces (body_yaw), and how sure that is.
struct YawEstimate {
  float yaw_rad = 0.F;     ///< 0 faces the camera, positive is turned to the person's own left; -pi to pi
  float confidence = 0.F;  ///< probability of the likeliest heading and its two neighbours, or how votes agree; 0-1
};

/// A point that the camera sees on a person, and which parts it may belong to.
struct PersonPoint {
  static constexpr int kParts = 3;
  Eigen::Vector3f at;                       ///< metres, optical frame
  std::array<std::uint8_t, kParts> part{};  ///< the likeliest first; kBackground where there are fewer
  std::array<float, kParts> share{};        ///< probability of each among all parts, 0-1
};

/// Everything that was found about one person.
struct Person {
  Skeleton skeleton;                       ///< parts with 3-D centre, extent, confidence and state
  std::vector<std::vector<Joint>> joints;  ///< [joint set of the body model][joint]
  Mask mask;                               ///< 1 on the person's pixels
  LabelImage labels;                       ///< part of each of the person's pixels, kBackground elsewhere
  Box box;                                 ///< smallest box around the mask
  float score = 0.F;                       ///< 0-1, higher is more certain; what this frame alone tells
  std::optional<YawEstimate> yaw;          ///< which way the person faces, if the labeller knows headings
  std::vector<PersonPoint> points;         ///< some of the person's pixels with the likeliest parts of each
};

/// The points p with normal . p = offset, in metres, optical frame. The normal has length 1, the offset is not
/// negative.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float offset = 0.F;
  float area_m2 = 0.F;  ///< visible surface on it

  float distance(const Eigen::Vector3f& p) const { return std::abs(normal.dot(p) - offset); }
};

/// The people of a frame and the large flat surfaces about them.
struct Detection {
  std::vector<Person> people = {};  ///< the most certain first
  std::vector<Plane> planes = {};   ///< floor, walls and others, largest first (find_planes)
  bool whole = true;                ///< whether all of the picture was looked at, not a PictureRegion alone
};

/// Returns a map of the people of the frame's size: index in `people`, kBackground elsewhere. People whose masks are
/// empty have no pixels.
Image<std::uint8_t> body_index_map(const std::vector<Person>& people, int width, int height);

/// Returns the part labels of all people in one picture, kBackground elsewhere. People whose masks are empty have none.
LabelImage part_label_map(const std::vector<Person>& people, int width, int height);

/// What the confidence of a joint of a fitted body follows from.
struct TrustSignals {
  float log_sigma = 0.F;    ///< logarithm of the standard deviation of its place along an axis, metres
  float misfit = 0.F;       ///< FittedBody::misfit
  float bone_misfit = 0.F;  ///< mean squared deviations of the points on its bone, robustly; 0 without points
  float free = 0.F;         ///< 1 where the camera sees past its place, so that nobody is there; 0 elsewhere
  float shape = 0.F;        ///< how unusual the body is: the length of its shape, standard deviations
  float score = 0.F;        ///< log odds of the person's score, -4 to 4
  float unseen_s = 0.F;     ///< time since the person was found, seconds
};

/// A bone of a body that was fitted to a person, in the order of the flesh model's bones.
struct FittedBone {
  State state = State::none;                             ///< observed where the camera sees flesh about the head
  Eigen::Vector3f head = Eigen::Vector3f::Zero();        ///< joint about which it turns, metres, optical frame
  Eigen::Vector3f tail = Eigen::Vector3f::Zero();        ///< its other end
  Eigen::Quaternionf global{1.F, 0.F, 0.F, 0.F};         ///< optical frame from the bone's
  Eigen::Quaternionf local{1.F, 0.F, 0.F, 0.F};          ///< parent's frame from the bone's; of the root as `global`
  float length_m = 0.F;                                  ///< length from head to tail
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();  ///< covariance of the head in square metres
  int support = 0;                                       ///< points of the person on the bone
  float confidence = 0.F;         ///< probability that the head lies within 10 cm of the truth, 0-1
  float tail_confidence = 0.F;    ///< the same of the tail
  TrustSignals of_head, of_tail;  ///< what the confidences follow from
};

/// A body fitted to one person.
struct FittedBody {
  std::vector<FittedBone> bones;
  std::vector<float> shape;  ///< coefficients of the flesh model's shapes, in standard deviations of the population
  float stature_m = 0.F;     ///< height of the body standing upright
  float misfit = 0.F;        ///< mean cost of a point, lower is better
  bool hidden = false;       ///< moved on from an earlier frame, since the person was not found in this one
};

/// All points near a line from one point to another, within a radius that changes evenly along it. Metres.
struct Capsule {
  Eigen::Vector3f from = Eigen::Vector3f::Zero(), to = Eigen::Vector3f::Zero();
  float from_radius = 0.F, to_radius = 0.F;

  /// Returns how far a point is outside, below 0 inside.
  float distance(const Eigen::Vector3f& point) const {
    const Eigen::Vector3f axis = to - from, offset = point - from;
    const float along = std::clamp(offset.dot(axis) / std::max(axis.squaredNorm(), 1e-8F), 0.F, 1.F);
    return (offset - along * axis).norm() - (from_radius + along * (to_radius - from_radius));
  }
};

/// What one frame tells about how somebody holds the body. Heights are over the floor; what is not seen is not known.
struct Posture {
  std::optional<float> stature_m;   ///< height of the person standing upright, by the fitted body
  std::optional<float> top_m;       ///< height of the person's highest pixels
  std::optional<float> chest_m;     ///< height of the chest, or of the neck or the head where no chest is seen
  std::optional<float> hips_m;      ///< height of the hips
  std::optional<float> trunk_up;    ///< cosine of the trunk's axis, from hips to chest and head, against up; 1 upright
  std::optional<float> thighs_up;   ///< cosine of the thighs' axis, from knees to hips, against up
  std::optional<float> pitch_m;     ///< height of head or neck above the chest
  std::optional<float> vertical_m;  ///< distance between the heights below which 10 and 90 % of the person's pixels are
};

/// What is known about somebody over frames.
enum class TrackState {
  seen,     ///< found in this frame by a detector alone, which does not follow people
  fresh,    ///< found, but not yet for long enough to be sure of
  tracked,  ///< found in this frame
  hidden,   ///< not found in this frame; the place is a prediction
  lost      ///< given up in this frame; the id is kept for somebody who looks the same and comes back
};
const char* to_string(TrackState state);

/// How somebody holds the body over the floor.
enum class Stance { unknown, standing, sitting, lying, fallen };
const char* to_string(Stance stance);

/// Whom one of several cameras has somebody for (docs/cameras.md).
struct SeenBy {
  int camera = 0;  ///< its number, from 0
  int id = 0;      ///< the person's id there
  TrackState state = TrackState::tracked;
};

/// Somebody in a frame, followed over frames or seen in this one alone.
struct TrackedPerson {
  int id = 0;  ///< from 1; the same for one person over a run, never used for two; of those only seen the index
  TrackState state = TrackState::fresh;
  /// As found in this frame; its joints are those of the fitted body where there is one. Of hidden people the mask and
  /// the labels are empty, and parts and joints are predicted.
  Person person;
  std::optional<FittedBody> body;
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< place of the trunk in metres, optical frame
  Eigen::Vector3f velocity = Eigen::Vector3f::Zero();  ///< velocity of the trunk in metres a second
  std::optional<Posture> posture;                      ///< what is known of the posture in this frame
  Stance stance = Stance::unknown;
  bool leaving = false;  ///< seen last at the border of the view, where people leave it
  double since_s = 0.0;  ///< time of the first frame in which the person was found
  double seen_s = 0.0;   ///< time of the last frame in which the person was found
  /// [joint set][joint]: joints smoothed over time, if that was asked for; otherwise empty.
  std::vector<std::vector<Joint>> smoothed;
  std::vector<SeenBy> seen_by;  ///< by camera, where the people of several are one list; otherwise empty
};

/// The floor and how the camera stands over it.
struct FloorView {
  Eigen::Vector3f up{0.F, -1.F, 0.F};  ///< unit vector away from the ground, optical frame
  float height_m = 0.F;                ///< height of the camera above the floor
  float tilt_rad = 0.F;                ///< angle of the viewing direction below the horizon; negative looks up
  float roll_rad = 0.F;                ///< turn about the viewing direction, clockwise as seen from the camera
};

/// Somebody's stance has changed.
struct StanceEvent {
  int id = 0;
  double time_s = 0.0;  ///< when the new stance began; earlier than the frame that reports it
  Stance stance = Stance::unknown;
  Stance before = Stance::unknown;  ///< the stance that it took the place of
};

/// The people of a frame: of one of a sequence over which they are followed, or as a detector found them (seen_people).
struct TrackedFrame {
  double time_s = 0.0;                ///< the frame's time, the latest's if it is late, or its number over the rate
  std::vector<TrackedPerson> people;  ///< by id; of lost ones those that were lost in this frame
  std::optional<FloorView> floor;
  std::vector<StanceEvent> events;
  bool followed = true;  ///< whether people are followed; otherwise there is nothing in it but them
};

/// Returns people as a detector found them, in their order: with their index as id, and a trunk that is not-a-number.
TrackedFrame seen_people(std::vector<Person> people);

/// Returns whether somebody was found in the frame, and not only expected there.
inline bool is_found(const TrackedPerson& person) { return person.state <= TrackState::tracked; }

/// Returns the people as they were found, in their order, so that each has the same index in both lists. Lost ones
/// and hidden ones who do not rest have empty masks.
std::vector<Person> people_of(const TrackedFrame& tracked);

}  // namespace vesalius
