#include "synth/pose/body_shapes.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// A shape in its bone's rest frame, metres.
struct RestShape {
  BodyRegion region;
  Bone bone;
  std::array<float, 3> from, to;
  float radius;
};

// These are the sizes of a slim adult 1.72 m tall, measured along the bones' rest directions. The trunk consists of
// capsules that lie across, since it is wider than deep. Thighs and upper arms begin below the joint, where they leave
// the trunk.
constexpr std::array<RestShape, kBodyShapes> kShapes{{
    {BodyRegion::hips, Bone::pelvis, {-0.07F, 0.02F, -0.02F}, {0.07F, 0.02F, -0.02F}, 0.105F},
    {BodyRegion::waist, Bone::spine, {-0.05F, 0.06F, 0.F}, {0.05F, 0.06F, 0.F}, 0.095F},
    {BodyRegion::chest, Bone::chest, {-0.06F, 0.03F, 0.F}, {0.06F, 0.03F, 0.F}, 0.10F},
    {BodyRegion::chest, Bone::chest, {-0.08F, 0.12F, 0.F}, {0.08F, 0.12F, 0.F}, 0.095F},
    {BodyRegion::head, Bone::neck, {0.F, 0.04F, 0.F}, {0.F, 0.08F, 0.F}, 0.05F},
    {BodyRegion::head, Bone::head, {0.F, 0.06F, 0.015F}, {0.F, 0.13F, 0.01F}, 0.085F},
    {BodyRegion::l_upper_arm, Bone::l_upper_arm, {0.12F, 0.F, 0.F}, {0.31F, 0.F, 0.F}, 0.042F},
    {BodyRegion::l_lower_arm, Bone::l_forearm, {0.03F, 0.F, 0.F}, {0.24F, 0.F, 0.F}, 0.035F},
    {BodyRegion::l_lower_arm, Bone::l_hand, {0.02F, 0.F, 0.02F}, {0.10F, 0.F, 0.02F}, 0.02F},
    {BodyRegion::l_lower_arm, Bone::l_hand, {0.02F, 0.F, -0.02F}, {0.10F, 0.F, -0.02F}, 0.02F},
    {BodyRegion::r_upper_arm, Bone::r_upper_arm, {-0.12F, 0.F, 0.F}, {-0.31F, 0.F, 0.F}, 0.042F},
    {BodyRegion::r_lower_arm, Bone::r_forearm, {-0.03F, 0.F, 0.F}, {-0.24F, 0.F, 0.F}, 0.035F},
    {BodyRegion::r_lower_arm, Bone::r_hand, {-0.02F, 0.F, 0.02F}, {-0.10F, 0.F, 0.02F}, 0.02F},
    {BodyRegion::r_lower_arm, Bone::r_hand, {-0.02F, 0.F, -0.02F}, {-0.10F, 0.F, -0.02F}, 0.02F},
    {BodyRegion::l_thigh, Bone::l_thigh, {0.F, -0.16F, 0.F}, {0.F, -0.28F, 0.F}, 0.07F},
    {BodyRegion::l_thigh, Bone::l_thigh, {0.F, -0.28F, 0.F}, {0.F, -0.42F, 0.F}, 0.055F},
    {BodyRegion::l_lower_leg, Bone::l_shin, {0.F, -0.04F, 0.F}, {0.F, -0.25F, -0.01F}, 0.05F},
    {BodyRegion::l_lower_leg, Bone::l_shin, {0.F, -0.25F, 0.F}, {0.F, -0.42F, 0.F}, 0.04F},
    {BodyRegion::l_lower_leg, Bone::l_foot, {0.F, -0.03F, -0.03F}, {0.F, -0.04F, 0.17F}, 0.035F},
    {BodyRegion::r_thigh, Bone::r_thigh, {0.F, -0.16F, 0.F}, {0.F, -0.28F, 0.F}, 0.07F},
    {BodyRegion::r_thigh, Bone::r_thigh, {0.F, -0.28F, 0.F}, {0.F, -0.42F, 0.F}, 0.055F},
    {BodyRegion::r_lower_leg, Bone::r_shin, {0.F, -0.04F, 0.F}, {0.F, -0.25F, -0.01F}, 0.05F},
    {BodyRegion::r_lower_leg, Bone::r_shin, {0.F, -0.25F, 0.F}, {0.F, -0.42F, 0.F}, 0.04F},
    {BodyRegion::r_lower_leg, Bone::r_foot, {0.F, -0.03F, -0.03F}, {0.F, -0.04F, 0.17F}, 0.035F},
    {BodyRegion::head, Bone::head, {0.F, 0.02F, 0.05F}, {0.F, 0.06F, 0.06F}, 0.05F},
}};

/// Approximate share of the body's mass at the middle of each bone; Winter, table 4.1: trunk with head 0.578, arms 0.05
/// each, thighs 0.1, shins with feet 0.061 each.
constexpr std::array<float, kBoneCount> kMass = {0.142F,  0.139F,  0.216F, 0.02F,   0.061F, 0.F,    0.028F,
                                                 0.016F,  0.006F,  0.F,    0.028F,  0.016F, 0.006F, 0.1F,
                                                 0.0465F, 0.0145F, 0.1F,   0.0465F, 0.0145F};

}  // namespace

std::array<BodyShape, kBodyShapes> body_shapes(const Pose& pose) {
  const StickFigure figure = stick_figure(pose);
  const auto world = world_rotations(pose);
  std::array<BodyShape, kBodyShapes> placed;
  for (std::size_t i = 0; i < kBodyShapes; ++i) {
    const RestShape& shape = kShapes[i];
    const auto bone = static_cast<std::size_t>(shape.bone);
    const auto place = [&](const std::array<float, 3>& p) {
      return (figure.head[bone] + world[bone] * Vector3f(p[0], p[1], p[2])).eval();
    };
    placed[i] = {shape.region, shape.bone, place(shape.from), place(shape.to), shape.radius};
  }
  return placed;
}

Vector3f centre_of_mass(const StickFigure& figure) {
  Vector3f sum = Vector3f::Zero();
  float mass = 0.F;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    sum += kMass[b] * 0.5F * (figure.head[b] + figure.tail[b]);
    mass += kMass[b];
  }
  return sum / mass;
}

}  // namespace vesalius::synth
