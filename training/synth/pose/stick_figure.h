#pragma once

#include <Eigen/Core>
#include <array>

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// The bones of a person of standard proportions in metres. The frame is the body frame, moved such that the point
/// midway between the hips is the origin.
struct StickFigure {
  std::array<Eigen::Vector3f, kBoneCount> head;  ///< joint about which the bone turns
  std::array<Eigen::Vector3f, kBoneCount> tail;

  const Eigen::Vector3f& head_of(Bone bone) const { return head[index(bone)]; }
  const Eigen::Vector3f& tail_of(Bone bone) const { return tail[index(bone)]; }
};

/// The stature of the standard person in metres.
inline constexpr float kStickStature_m = 1.72F;

/// Returns the length of a bone of the standard person in metres. Lengths are shares of the stature by Drillis and
/// Contini (1966), as printed in D. A. Winter, "Biomechanics and Motor Control of Human Movement", figure 4.1; the
/// trunk is divided at L3 and T10.
float bone_length_m(Bone bone);

StickFigure stick_figure(const Pose& pose);

/// Returns the position of a bone's head at rest relative to the head of its parent, in metres.
Eigen::Vector3f rest_offset_m(Bone bone);

}  // namespace vesalius::synth
