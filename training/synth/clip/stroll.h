#pragma once

#include <optional>
#include <vector>

#include "synth/clip/tracks.h"
#include "synth/scene/occupancy.h"

namespace vesalius::synth {

/// What a person can do: walk, and stay at one place in several ways.
struct Repertoire {
  Gait gait;
  std::vector<Movement> stays;  ///< at least one
  float leg_m = 0.85F;          ///< hip to ankle, which scales the ways
};

/// A person who walks about and stays, as numbers without poses, so that ways can be tried cheaply. A walk runs up,
/// down and into a stay within about half a second.
struct StrollState {
  Eigen::Vector2f at = Eigen::Vector2f::Zero();
  float heading_rad = 0.F;
  float turn_rad_s = 0.F;
  float go = 0.F;        ///< 0 stands, 1 walks at full speed
  float gait_s = 0.F;    ///< time in the gait
  float staying = 1.F;   ///< 0 has the gait's pose, 1 that of the stay
  std::size_t stay = 0;  ///< index in Repertoire::stays
  float stay_s = 0.F;    ///< time in it
  float fade = 1.F;      ///< 0 has the pose of the stay before, 1 that of this one
  std::size_t held = 0;  ///< the stay before, and the time at which it ended
  float held_s = 0.F;
};

/// Advances by 1 / kTrackRate_hz: towards `goal`, or stays where there is none.
void advance(const Repertoire& can, const std::optional<Eigen::Vector2f>& goal, StrollState& state);

/// Returns how the person looks in a state.
TrackState shown(const Repertoire& can, const StrollState& state);

/// Moves a person over the floor such that the foot that carries the weight slides less, as it does where a way turns,
/// speeds up or fits the legs badly. The way stays the planned one to within about 15 cm, to which it returns within a
/// second or so. `leg_m` is the length from hip to ankle.
void plant_feet(float leg_m, PersonTrack& track);

/// What is there when a person's way is planned.
struct StrollGround {
  View view;                        ///< view of the camera in the middle of the places to which it goes
  float camera_reach_m = 0.F;       ///< how far the camera goes from there
  std::vector<OrientedBox> solids;  ///< seats, beds and tables in the world
  std::vector<PersonTrack> people;  ///< who is there already
  std::vector<std::vector<Eigen::Vector2f>> footprints;  ///< x and z of bones of those who stay on seats and beds
};

/// What is asked of a way.
struct StrollWish {
  bool walks = true;    ///< false stays at the first place
  bool crosses = true;  ///< passes before or behind somebody who is there, as far as that is possible
};

/// Plans where a person walks and stays for so many seconds: places in the camera's view and at its distances, now and
/// then outside. Keeps 0.75 m from other people's middles, 0.35 m from things, and away from the camera. Returns
/// nothing if no way is found after a bounded number of tries. The same arguments give the same way.
std::optional<PersonTrack> plan_stroll(const ClipOptions& options, const CameraPlacement& placement,
                                       const StrollGround& ground, const Repertoire& can, const StrollWish& wish,
                                       float seconds, Random& random);

}  // namespace vesalius::synth
