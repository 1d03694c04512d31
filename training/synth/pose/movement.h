#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "synth/pose/pose.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// A body at one moment of a movement. Lengths are in lengths of the leg (hip to ankle), so that they fit any body.
struct BodyState {
  Pose pose;                                       ///< the pelvis has no heading
  float heading_rad = 0.F;                         ///< heading of the pelvis about y; positive to the person's own left
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

/// A walk straight ahead that repeats after a period. Lengths are in lengths of the leg.
struct Gait {
  float period_s = 1.F;
  /// States evenly over the period; after the last comes the first again. Of a state's root y is the way ahead since
  /// the first state and x the sway to the person's left; headings are relative to the way.
  std::vector<BodyState> states;
  float stride = 0.F;  ///< way ahead in one period, above 0

  float speed() const { return stride / period_s; }
};

/// Returns the state at a time of any size. The way ahead goes on from period to period.
BodyState state_at(const Gait& gait, float time_s);
/// Returns that state's root alone, which is much faster.
Eigen::Vector2f root_at(const Gait& gait, float time_s);

Gait mirrored(Gait gait);

/// Finds the period of a recorded walk that repeats best: straight, facing ahead, at 0.35 to 2.3 leg lengths a second,
/// and with about the same pose at both ends, where the difference is spread over the period. Returns nothing if there
/// is none, as in other movements.
std::optional<Gait> find_gait(const Movement& movement);

/// Draws a walk without any files: angles of normal gait (pose_kinds.h). The way ahead is that which keeps the standing
/// foot in place.
Gait sample_gait(Random& random);

}  // namespace vesalius::synth
