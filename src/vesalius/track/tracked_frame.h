#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "vesalius/detection.h"
#include "vesalius/fit/fitted_body.h"
#include "vesalius/track/posture.h"

namespace vesalius {

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
};

/// The people of a frame: of one of a sequence over which they are followed, or as a detector found them (seen_people).
struct TrackedFrame {
  double time_s = 0.0;                ///< the frame's time, or its number over the rate where it has none
  std::vector<TrackedPerson> people;  ///< by id; of lost ones those that were lost in this frame
  std::optional<FloorView> floor;
  std::vector<StanceEvent> events;
  bool followed = true;  ///< whether people are followed; otherwise there is nothing in it but them
};

/// Returns people as a detector found them, in their order: with their index as id, and a trunk that is not-a-number.
TrackedFrame seen_people(std::vector<Person> people);

/// Returns whether somebody was found in the frame, and not only expected there.
inline bool is_found(const TrackedPerson& person) { return person.state <= TrackState::tracked; }

/// Returns the people as they were found, in their order, so that each has the same index in both lists. Hidden and
/// lost ones have empty masks.
std::vector<Person> people_of(const TrackedFrame& tracked);

/// Returns joint_rotations by the person's body; without one nothing for every joint.
std::vector<std::optional<Eigen::Quaternionf>> rotations_of(const TrackedPerson& person, const JointSet& set);

}  // namespace vesalius
