#pragma once

#include <Eigen/Core>
#include <array>

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Returns where the bones of a person of standard proportions are, in the body frame moved so that the middle between
/// the hips is the origin, metres.
struct StickFigure {
  std::array<Eigen::Vector3f, kBoneCount> head;  ///< joint that the bone turns about
  std::array<Eigen::Vector3f, kBoneCount> tail;

  const Eigen::Vector3f& head_of(Bone bone) const { return head[index(bone)]; }
  const Eigen::Vector3f& tail_of(Bone bone) const { return tail[index(bone)]; }
};

/// Stature of the standard person, metres.
inline constexpr float kStickStature_m = 1.72F;

/// Length of a bone of the standard person, metres: shares of the stature by Drillis and Contini (1966), as printed in
/// D. A. Winter, "Biomechanics and Motor Control of Human Movement", figure 4.1; the trunk is cut at L3 and T10.
float bone_length_m(Bone bone);

StickFigure stick_figure(const Pose& pose);

/// Place of a bone's head at rest, seen from the head of its parent, metres.
Eigen::Vector3f rest_offset_m(Bone bone);

}  // namespace vesalius::synth
