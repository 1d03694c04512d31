#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// A body at one moment of a movement. Lengths are in lengths of the leg (hip to ankle), so that they fit any body.
struct BodyState {
  Pose pose;                                       ///< the pelvis has no heading
  float heading_rad = 0.F;                         ///< of the pelvis about y; positive to the person's own left
  Eigen::Vector2f root = Eigen::Vector2f::Zero();  ///< x and z of the pelvis over the floor
  float height = 0.F;                              ///< y of the pelvis above any level; bodies are put on the floor
};

/// A movement of a body without its size: states at a constant rate. Headings are continuous, they do not wrap.
struct Movement {
  std::string name;
  float fps = 30.F;
  std::vector<BodyState> states;

  float seconds() const { return float(states.size() - 1) / fps; }
};

/// Returns the pose between two: 0 gives `a`, 1 gives `b`. Each joint turns the shorter way.
Pose interpolated(const Pose& a, const Pose& b, float share);

/// Returns the state at a time; before the first and after the last state it is these. There must be a state.
BodyState state_at(const Movement& movement, float time_s);
/// Returns that state's root or heading alone, which is much faster.
Eigen::Vector2f root_at(const Movement& movement, float time_s);
float heading_at(const Movement& movement, float time_s);

/// Returns the mirror image (x -> -x).
Movement mirrored(Movement movement);

}  // namespace vesalius::synth
