#pragma once

#include "synth/pose/joint_angles.h"
#include "vesalius/base/random.h"

/// The kinds of poses that sample_pose() draws from, one function for each. A pose may run through its own body; the
/// sampler rejects it then.
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
/// Every angle uniform in its range, upright.
Pose any(Random& random);

/// Returns a number uniform over [low, high).
float between(Random& random, float low, float high);
bool chance(Random& random, float probability);

/// Returns the angles of somebody who stands: legs, trunk, neck and hanging arms.
BodyAngles standing_angles(Random& random);
/// Returns an arm that hangs, or is swung by so many degrees to the front and to the side.
ArmAngles hanging_arm(Random& random, float front, float side);
/// Returns the angle of the ankle that puts the sole level under a pelvis of that pitch.
float level_ankle(const LegAngles& leg, float pitch);

/// Returns where a point fixed to a bone is in the stick figure's frame; `offset_m` is seen from the bone's head, at
/// rest. For the left side: `left` false takes the mirror image.
Eigen::Vector3f point_on(const Pose& pose, Bone bone, const Eigen::Vector3f& offset_m);
/// Returns the vector for the left side, its mirror image (x -> -x) for the right.
Eigen::Vector3f on_side(const Eigen::Vector3f& v, bool left);

/// These change the arms alone, whatever the legs do. Hands keep clear of trunk and legs as far as the pose lets them.
void cross_arms(Pose& pose, Random& random);
void fold_behind(Pose& pose, Random& random);
void put_on_hip(Pose& pose, bool left, Random& random);
void hold_in_front(Pose& pose, Random& random);
void phone_to_ear(Pose& pose, bool left, Random& random);
void phone_in_hand(Pose& pose, bool left, Random& random);
void hand_on_thigh(Pose& pose, bool left, Random& random);
void hand_on_table(Pose& pose, bool left, Random& random);
void hand_to_face(Pose& pose, bool left, Random& random);
void hand_behind_head(Pose& pose, bool left, Random& random);
void hand_on_belly(Pose& pose, bool left, Random& random);

}  // namespace vesalius::synth::kinds
