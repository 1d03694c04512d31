#pragma once

#include <optional>

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
Pose lie_on_back(Random& random);
Pose lie_on_side(Random& random);
Pose lie_on_front(Random& random);
/// Returns an upright pose with every angle uniform in its range.
Pose any(Random& random);

/// The kinds that rest on floor, hands, knees or feet in ways that not every draw allows: nothing is returned where
/// they do not hold.
std::optional<Pose> crawling(Random& random);
std::optional<Pose> sitting_up(Random& random);
std::optional<Pose> lying_varied(Random& random);
std::optional<Pose> picking_up(Random& random);
/// Moments on the way between lying, sitting, kneeling, squatting and standing, between back, side and front, and in
/// falls.
std::optional<Pose> getting_up(Random& random);
std::optional<Pose> turning_over(Random& random);
std::optional<Pose> falling(Random& random);
/// What hands do, of people who stand and sit.
Pose drinking(Random& random);
Pose handing(Random& random);
Pose hands_together(Random& random);
Pose touching_oneself(Random& random);
Pose leaning(Random& random);

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

/// Returns the vector itself for the left side and its mirror image (x -> -x) for the right.
Eigen::Vector3f on_side(const Eigen::Vector3f& v, bool left);
/// Returns the position of a point that is fixed to a bone, in the stick figure's frame. `offset_m` is the point's
/// place from the bone's head at rest.
Eigen::Vector3f point_on(const Pose& pose, Bone bone, const Eigen::Vector3f& offset_m);
/// Draws a point in a box, metres.
Eigen::Vector3f in_box(Random& random, const Eigen::Vector3f& low, const Eigen::Vector3f& high);
/// Moves the wrist to a point that is fixed to a bone. The elbow's direction turns with the chest. Both are given for
/// the left side.
void reach_point(Pose& pose, bool left, Bone bone, const Eigen::Vector3f& offset_m,
                 const Eigen::Vector3f& elbow_towards);
void set_grip(Pose& pose, bool left, float grip);

/// Returns the bend of the knee that puts the foot as low as the seat, for a thigh that rises by so many degrees. Shin
/// and thigh are about equally long, and hips are some 7 % of that length higher above the ground than ankles.
float knee_for_rise(float rise);
/// Sets the shin of a kneeling person whose thigh is so many degrees to the front of vertical. The ankle is higher than
/// the knee by the height of the foot, which is stretched backwards or stands on its toes.
void rest_on_knee(LegAngles& leg, float thigh, bool on_toes);

/// Returns the angles of a standing person: legs, trunk, neck and hanging arms.
BodyAngles standing_angles(Random& random);
/// Returns the angles of somebody who lies on the back with the arms at the sides.
BodyAngles on_back(Random& random);
/// Puts a hand flat on the floor under its shoulder, off by so much, as plant_hand() does. Offset and fingers are given
/// for the left side.
bool plant_below(Pose& pose, bool left, const Eigen::Vector3f& off_m, const Eigen::Vector3f& fingers);
/// Returns the pose after it has settled on the floor (settle()), if it tips by no more than so many degrees and the
/// legs are within their ranges.
std::optional<Pose> rested(Pose pose, float most_deg);
bool legs_in_range(const Pose& pose);
/// Returns whether hips and chest are near the floor, so that no arm or leg props up somebody who lies.
bool lies_on_trunk(const Pose& pose);
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
