#pragma once

#include "synth/pose/joint_angles.h"
#include "vesalius/base/random.h"

/// The kinds of poses from which sample_pose() draws, one function for each. A pose may intersect itself; the sampler
/// then rejects it.
namespace vesalius::synth::kinds {

Pose idle(Random& random);
Pose walking(Random& random);
Pose reaching(Random& random);
Pose waving(Random& random);
Pose bending(Random& random);
Pose arms_crossed(Random& random);
Pose arms_behind(Random& random);
Pose hands_on_hips(Random& random);
Pose carrying(Random& random);
Pose phone(Random& random);
Pose sitting(Random& random);
Pose floor_sitting(Random& random);
Pose lying(Random& random);
Pose kneeling(Random& random);
Pose squatting(Random& random);
/// Returns an upright pose with every angle uniform in its range.
Pose any(Random& random);

/// How somebody walks; walking() draws it together with a moment of it.
struct WalkStyle {
  float length = 1.F;                ///< length of the strides, 1 at natural cadence
  BodyAngles angles;                 ///< what is the same at all times
  std::array<float, 2> swing_deg{};  ///< angles of the arms to front and back
  std::array<float, 2> side_deg{};   ///< angles of the arms to their side
  std::array<float, 2> elbow_deg{};  ///< least bend
};
WalkStyle draw_walk(Random& random);
/// Returns the pose at a phase of the stride, 0 to 1; at 0 the left heel strikes.
Pose walking_at(const WalkStyle& style, float phase);

/// Returns a number uniform over [low, high).
float between(Random& random, float low, float high);
bool chance(Random& random, float probability);

/// Returns the angles of a standing person: legs, trunk, neck and hanging arms.
BodyAngles standing_angles(Random& random);
/// Returns a hanging arm that is swung by so many degrees to the front and to the side.
ArmAngles hanging_arm(Random& random, float front, float side);
/// Returns the ankle's angle at which the sole is level, given the pitch of the pelvis.
float level_ankle(const LegAngles& leg, float pitch);

/// These functions change only the arms, whatever the legs do. Hands avoid trunk and legs as far as the pose allows.
void cross_arms(Pose& pose, Random& random);
void phone_to_ear(Pose& pose, bool left, Random& random);
void phone_in_hand(Pose& pose, bool left, Random& random);
void hand_on_thigh(Pose& pose, bool left, Random& random);
void hand_on_table(Pose& pose, bool left, Random& random);
void hand_to_face(Pose& pose, bool left, Random& random);
void hand_behind_head(Pose& pose, bool left, Random& random);
void hand_on_belly(Pose& pose, bool left, Random& random);

}  // namespace vesalius::synth::kinds
