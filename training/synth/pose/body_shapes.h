#pragma once

#include <array>
#include <cstdint>

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// The region of a capsule. Capsules of one region are never compared, nor are those of neighbouring regions.
enum class BodyRegion : std::uint8_t {
  hips,
  waist,
  chest,
  head,
  l_upper_arm,
  l_lower_arm,
  r_upper_arm,
  r_lower_arm,
  l_thigh,
  l_lower_leg,
  r_thigh,
  r_lower_leg
};

/// A rounded piece of the body: all points within `radius_m` of a segment.
struct BodyShape {
  BodyRegion region;
  Bone bone;
  Eigen::Vector3f from, to;
  float radius_m;
};
inline constexpr int kBodyShapes = 25;

/// Returns the shapes of a slim adult of standard proportions in a pose, in the frame of stick_figure().
std::array<BodyShape, kBodyShapes> body_shapes(const Pose& pose);

/// Returns the centre of the body's mass.
Eigen::Vector3f centre_of_mass(const StickFigure& figure);

}  // namespace vesalius::synth
