#pragma once

#include <array>

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// The angles of an arm in degrees. They are 0 if the arm hangs straight with its palm to the thigh.
struct ArmAngles {
  float elevation = 5.F;  ///< angle of the upper arm from hanging, 0 to 180
  float plane = 0.F;      ///< direction of elevation: 0 is to the side, 90 front, -90 back, over 90 across the body
  float external = 0.F;   ///< turn of the upper arm about its axis; turns the elbow's bend outwards
  float elbow = 0.F;      ///< bend
  float pronation = 0.F;  ///< turn of the hand about the forearm; the palm of a hanging arm turns backwards
  float wrist = 0.F;      ///< bend towards the palm
  float ulnar = 0.F;      ///< bend towards the little finger
  float shrug = 0.F;      ///< angle of the clavicle upwards
  float forward = 0.F;    ///< angle of the clavicle to the front
};

/// The angles of a leg in degrees. They are 0 if the leg stands straight.
struct LegAngles {
  float flexion = 0.F;    ///< angle of the hip; moves the knee to the front
  float abduction = 0.F;  ///< angle of the hip; moves the knee outwards
  float external = 0.F;   ///< turn of the thigh about its axis; turns the toes outwards
  float knee = 0.F;       ///< bend
  float ankle = 0.F;      ///< bend that lifts the toes
};

/// The angles of the lumbar and thoracic spine together, or of neck and head together, in degrees.
struct SpineAngles {
  float flexion = 0.F;  ///< to the front
  float lateral = 0.F;  ///< to the person's left
  float turn = 0.F;     ///< to the person's left
};

/// A pose in the angles of anatomy. Of arms and legs, [0] is left and [1] right.
struct BodyAngles {
  float pitch = 0.F;  ///< angle of the pelvis to the front; at -90 a person lies on the back
  float roll = 0.F;   ///< angle of the pelvis to the person's left; at 90 a person lies on the left side
  SpineAngles trunk;
  SpineAngles neck;
  std::array<ArmAngles, 2> arms;
  std::array<LegAngles, 2> legs;
  std::array<float, 2> grip{0.3F, 0.3F};  ///< 0 is a stretched hand, 1 a fist
};

/// The range of a joint, in degrees.
struct JointRange {
  float low;
  float high;
};

/// The ranges of motion of healthy adults in degrees: American Academy of Orthopaedic Surgeons (AAOS), "Joint Motion:
/// Method of Measuring and Recording" (1965), as tabulated in Norkin and White, "Measurement of Joint Motion". Three
/// ranges are wider, because other limbs and the body's weight push joints further than the measured muscles do: knee
/// 150 (AAOS 135), ankle 35 (AAOS 20), and internal turn of the arm 95, which putting a hand on the back takes (AAOS
/// 70; Kapandji, "The Physiology of the Joints", volume 1).
namespace range {
inline constexpr JointRange kElevation{0.F, 180.F};
inline constexpr float kExtension = 60.F;          ///< elevation to the back (plane -90)
inline constexpr JointRange kPlane{-90.F, 135.F};  ///< 135 is a horizontal adduction of 45 past the front
inline constexpr JointRange kArmExternal{-95.F, 90.F};
inline constexpr JointRange kElbow{0.F, 150.F};
inline constexpr JointRange kPronation{-80.F, 80.F};
inline constexpr JointRange kWrist{-70.F, 80.F};
inline constexpr JointRange kUlnar{-20.F, 30.F};
inline constexpr JointRange kShrug{-5.F, 25.F};  ///< sternoclavicular; Inman, Saunders and Abbott (1944)
inline constexpr JointRange kForward{-15.F, 20.F};
inline constexpr JointRange kHipFlexion{-30.F, 120.F};
inline constexpr JointRange kHipAbduction{-30.F, 45.F};
inline constexpr JointRange kHipExternal{-45.F, 45.F};
inline constexpr JointRange kKnee{0.F, 150.F};
inline constexpr JointRange kAnkle{-50.F, 35.F};
inline constexpr JointRange kTrunkFlexion{-25.F, 80.F};
inline constexpr JointRange kTrunkLateral{-35.F, 35.F};
inline constexpr JointRange kTrunkTurn{-45.F, 45.F};
inline constexpr JointRange kNeckFlexion{-45.F, 45.F};
inline constexpr JointRange kNeckLateral{-45.F, 45.F};
inline constexpr JointRange kNeckTurn{-60.F, 60.F};
}  // namespace range

/// Returns the angles, each clamped to its range.
BodyAngles within_range(BodyAngles angles);

/// Returns the pose of these angles. Spine and chest share the trunk's angles, neck and head the neck's.
Pose pose_of(const BodyAngles& angles);

/// Returns the angles of a pose's arm, the inverse of `pose_of`. Angles of the clavicle are returned as 0.
ArmAngles arm_angles(const Pose& pose, bool left);

/// Returns whether the arm stays within the ranges, with two degrees of tolerance.
bool arm_in_range(const ArmAngles& arm);

/// The same for a leg.
LegAngles leg_angles(const Pose& pose, bool left);
bool leg_in_range(const LegAngles& leg);

/// Sets upper arm and forearm, without moving clavicles or trunk, such that the wrist of a person of standard
/// proportions (stick_figure()) reaches `wrist_m`, or comes as near as the arm's length and the elbow allow.
/// `elbow_towards` is the direction in which the elbow points. Both are in the frame of the stick figure. The hand
/// stays in line with the forearm.
void reach(Pose& pose, bool left, const Eigen::Vector3f& wrist_m, const Eigen::Vector3f& elbow_towards);

/// Sets the hand's angles relative to the forearm, in degrees as in ArmAngles.
void set_hand(Pose& pose, bool left, float pronation, float wrist, float ulnar);

/// Turns the hand such that its fingers point along `fingers` and its palm faces `palm`, as far as forearm and wrist
/// allow. Both are directions in the frame of the stick figure and not parallel.
void point_hand(Pose& pose, bool left, const Eigen::Vector3f& fingers, const Eigen::Vector3f& palm);

/// Sets thigh and shin such that the ankle of a person of standard proportions reaches `ankle_m`, or comes as near as
/// the leg allows, as reach() does for the wrist. The foot keeps its angle to the shin.
void place_ankle(Pose& pose, bool left, const Eigen::Vector3f& ankle_m, const Eigen::Vector3f& knee_towards);

/// Bends the ankle, as far as it can, such that the foot rises to its toes by so many degrees; 0 is a level sole.
void slope_foot(Pose& pose, bool left, float rise_deg);

}  // namespace vesalius::synth
