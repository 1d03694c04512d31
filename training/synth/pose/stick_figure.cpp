#include "synth/pose/stick_figure.h"

namespace vesalius::synth {
namespace {

/// The proportions of a bone as shares of the stature.
struct Proportion {
  float length;
  std::array<float, 3> offset;  ///< from the head of its parent to its own, at rest
};

constexpr std::array<Proportion, kBoneCount> kProportions{{
    {0.060F, {0.F, 0.F, 0.F}},         // pelvis: from midway between the hips to the lumbar spine
    {0.110F, {0.F, 0.060F, -0.010F}},  // spine
    {0.120F, {0.F, 0.110F, 0.F}},      // chest: up to the neck
    {0.052F, {0.F, 0.120F, 0.F}},      // neck
    {0.130F, {0.F, 0.052F, 0.010F}},   // head
    {0.099F, {0.014F, 0.112F, 0.F}},   // clavicles: the joints are within the width of the shoulders
    {0.186F, {0.099F, 0.F, 0.F}},      // upper arms
    {0.146F, {0.186F, 0.F, 0.F}},      // forearms
    {0.108F, {0.146F, 0.F, 0.F}},      // hands
    {0.099F, {-0.014F, 0.112F, 0.F}},  //
    {0.186F, {-0.099F, 0.F, 0.F}},     //
    {0.146F, {-0.186F, 0.F, 0.F}},     //
    {0.108F, {-0.146F, 0.F, 0.F}},     //
    {0.245F, {0.055F, 0.F, 0.F}},      // thighs: the joints are within the width of the hips
    {0.246F, {0.F, -0.245F, 0.F}},     // shins
    {0.110F, {0.F, -0.246F, 0.F}},     // feet: in front of the ankle
    {0.245F, {-0.055F, 0.F, 0.F}},     //
    {0.246F, {0.F, -0.245F, 0.F}},     //
    {0.110F, {0.F, -0.246F, 0.F}},     //
}};

}  // namespace

float bone_length_m(Bone bone) { return kProportions[index(bone)].length * kStickStature_m; }

Eigen::Vector3f rest_offset_m(Bone bone) {
  const auto& o = kProportions[index(bone)].offset;
  return Eigen::Vector3f(o[0], o[1], o[2]) * kStickStature_m;
}

StickFigure stick_figure(const Pose& pose) {
  const auto world = world_rotations(pose);
  StickFigure out;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const auto bone = static_cast<Bone>(b);
    const auto up = static_cast<std::size_t>(parent(bone));
    out.head[b] = b == 0 ? Eigen::Vector3f::Zero().eval() : (out.head[up] + world[up] * rest_offset_m(bone)).eval();
    out.tail[b] = out.head[b] + world[b] * (rest_direction(bone) * bone_length_m(bone));
  }
  return out;
}

}  // namespace vesalius::synth
