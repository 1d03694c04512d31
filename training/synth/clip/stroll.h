#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "synth/clip/person_track.h"
#include "synth/pose/gait.h"
#include "synth/pose/movement.h"

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

}  // namespace vesalius::synth
