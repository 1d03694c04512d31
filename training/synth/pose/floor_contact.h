#pragma once

#include <optional>

#include "synth/pose/pose.h"

/// How bodies rest on the floor. Skin is that of body_shapes(), of shoulders and heels; positions are in the frame of
/// stick_figure(), directions as well.
namespace vesalius::synth {

/// Heights of the wrist of a hand that lies flat on the floor, of the ankle over a level sole, and of an elbow.
inline constexpr float kFlatWrist_m = 0.035F, kFlatAnkle_m = 0.075F, kRestingElbow_m = 0.04F;

/// Returns the height of the lowest skin of trunk, head and legs, and of the arms if asked.
float floor_y(const Pose& pose, bool with_arms = true);

/// Returns the lowest height of a bone's skin over the body's lowest skin, metres. Bones without skin of their own,
/// such as clavicles, give nothing.
std::optional<float> skin_height_m(const Pose& pose, Bone bone);

/// Returns how far the body's weight is outside of what carries it, metres over the floor: the convex hull of the skin
/// that is within a hand's thickness of the lowest. It is 0 or less if the body is in balance.
float out_of_support_m(const Pose& pose);

/// Tips the body over, as if it were stiff, until it rests on the floor with its weight over what carries it. Returns
/// by how many degrees that was; poses that rest already remain as they are.
float settle(Pose& pose);
/// Tips the body along its trunk only, as somebody who lies rests on whole length but does not roll.
float settle_lengthwise(Pose& pose);

/// Puts a hand flat on the floor, with the wrist above a point of it and the fingers in a direction. Only the arm
/// moves. Returns whether the arm is long enough.
bool plant_hand(Pose& pose, bool left, const Eigen::Vector3f& at, const Eigen::Vector3f& fingers);

/// Puts elbow and forearm on the floor at height `floor_y`. Elbow and hand are in the given directions over the floor
/// from shoulder and elbow. Returns whether the shoulder is at a height that allows it.
bool plant_forearm(Pose& pose, bool left, float floor_y, const Eigen::Vector3f& elbow_towards,
                   const Eigen::Vector3f& hand_towards);

/// Turns a pose about the vertical to where it differs least from another in the pelvis.
Pose facing_as(Pose pose, const Pose& other);

}  // namespace vesalius::synth
