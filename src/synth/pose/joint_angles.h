#pragma once

#include <array>

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Angles of an arm in degrees, 0 where it hangs straight with the palm to the thigh.
struct ArmAngles {
  float elevation = 5.F;  ///< of the upper arm away from hanging, 0 to 180
  float plane = 0.F;      ///< of that: 0 to the side, 90 to the front, -90 to the back, beyond 90 across the body
  float external = 0.F;   ///< turn of the upper arm about itself; elbow's bend goes outwards
  float elbow = 0.F;      ///< bend
  float pronation = 0.F;  ///< turn of the hand about the forearm: palm to the back where the arm hangs
  float wrist = 0.F;      ///< bend to the palm
  float ulnar = 0.F;      ///< bend to the little finger
  float shrug = 0.F;      ///< clavicle up
  float forward = 0.F;    ///< clavicle to the front
};

/// Angles of a leg in degrees, 0 where it stands straight.
struct LegAngles {
  float flexion = 0.F;    ///< of the hip: knee to the front
  float abduction = 0.F;  ///< knee outwards
  float external = 0.F;   ///< turn of the thigh about itself: toes outwards
  float knee = 0.F;       ///< bend
  float ankle = 0.F;      ///< toes up
};

/// Angles of the lumbar and thoracic spine together, or of neck and head together, degrees.
struct SpineAngles {
  float flexion = 0.F;  ///< to the front
  float lateral = 0.F;  ///< to the person's left
  float turn = 0.F;     ///< to the person's left
};

/// A pose as anatomists write it. Arms and legs: [0] left, [1] right.
struct BodyAngles {
  float pitch = 0.F;  ///< of the pelvis, degrees: to the front; -90 lies on the back
  float roll = 0.F;   ///< of the pelvis, degrees: to the person's left; 90 lies on the left side
  SpineAngles trunk;
  SpineAngles neck;
  std::array<ArmAngles, 2> arms;
  std::array<LegAngles, 2> legs;
  std::array<float, 2> grip{0.3F, 0.3F};  ///< 0 stretched, 1 a fist
};

/// The range of a joint, in degrees.
struct JointRange {
  float low;
  float high;
};

/// Ranges of motion of healthy adults: American Academy of Orthopaedic Surgeons, "Joint Motion: Method of Measuring
/// and Recording" (1965), as tabled in Norkin and White, "Measurement of Joint Motion". Three are wider, since other
/// limbs and the body's weight push further than the muscles that were measured: knee 150 (AAOS 135), ankle 35 (20),
/// internal turn of the arm 95, as it takes to put a hand on the back (AAOS 70; Kapandji, "The Physiology of the
/// Joints", volume 1).
namespace range {
inline constexpr JointRange kElevation{0.F, 180.F};
inline constexpr float kExtension = 60.F;          ///< elevation to the back (plane -90)
inline constexpr JointRange kPlane{-90.F, 135.F};  ///< 135: horizontal adduction of 45 past the front
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

/// The angles with each put into its range.
BodyAngles within_range(BodyAngles angles);

/// The pose of these angles. The trunk's are shared by spine and chest, the neck's by neck and head.
Pose pose_of(const BodyAngles& angles);

/// The arm of a pose, as `pose_of` reads it; clavicles come out as 0.
ArmAngles arm_angles(const Pose& pose, bool left);

/// Returns whether the arm stays in the ranges, with 2 degrees for rounding and bodies between two measurements.
bool arm_in_range(const ArmAngles& arm);

/// Sets upper arm and forearm (clavicles and trunk as they are) so that the wrist of a person of standard proportions
/// (stick_figure.h) gets to `wrist_m`, or as near as the arm is long and the elbow bends. Both in the frame of the
/// stick figure; `elbow_towards` is the direction in which the elbow points. The hand stays in line with the forearm.
void reach(Pose& pose, bool left, const Eigen::Vector3f& wrist_m, const Eigen::Vector3f& elbow_towards);

/// Sets the hand against the forearm, degrees as in ArmAngles.
void set_hand(Pose& pose, bool left, float pronation, float wrist, float ulnar);

}  // namespace vesalius::synth
