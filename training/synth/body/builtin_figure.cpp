#include "synth/body/builtin_figure.h"

#include <algorithm>
#include <cmath>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

Limb ellipsoid(Bone bone, const Vector3f& centre, const Vector3f& half_axes, bool paired) {
  // Half axes are given as x, y, z; an ellipsoid's line runs along y.
  return {{{centre, half_axes.x(), half_axes.z(), half_axes.y()}},
          Vector3f::UnitX(),
          Vector3f::UnitY(),
          {{index(bone), 0.F, 0.F}},
          paired};
}

/// Returns additional stations on a smooth line through the given ones (Catmull-Rom), because straight cones would show
/// as folds.
std::vector<Station> smoothed(const std::vector<Station>& rough) {
  const auto mix = [](float a, float b, float c, float d, float t) {
    return b + 0.5F * t * (c - a + t * (2.F * a - 5.F * b + 4.F * c - d + t * (3.F * (b - c) + d - a)));
  };
  std::vector<Station> fine;
  for (std::size_t k = 0; k + 1 < rough.size(); ++k) {
    const Station& a = rough[k == 0 ? 0 : k - 1];
    const Station& b = rough[k];
    const Station& c = rough[k + 1];
    const Station& d = rough[std::min(k + 2, rough.size() - 1)];
    for (const float t : {0.F, 1.F / 3.F, 2.F / 3.F}) {
      Station s;
      for (int i = 0; i < 3; ++i) s.centre[i] = mix(a.centre[i], b.centre[i], c.centre[i], d.centre[i], t);
      s.wide = mix(a.wide, b.wide, c.wide, d.wide, t);
      s.deep = mix(a.deep, b.deep, c.deep, d.deep, t);
      s.cap = b.cap;
      fine.push_back(s);
    }
  }
  fine.push_back(rough.back());
  return fine;
}

struct Ring {
  float place;                          ///< 0 is at the hip joints, 1 at the base of the neck
  float woman_wide, man_wide, deep, z;  ///< shares of the stature
  float waist;                          ///< share of the build that widens the waist here
};

void add_trunk(const Measures& m, BuiltinFigure& f) {
  constexpr std::array<Ring, 9> kRings{{
      {-0.12F, 0.052F, 0.050F, 0.046F, -0.004F, 0.F},
      {0.02F, 0.099F, 0.090F, 0.063F, -0.006F, 0.1F},
      {0.15F, 0.094F, 0.088F, 0.060F, -0.001F, 0.6F},
      {0.32F, 0.072F, 0.081F, 0.054F, 0.004F, 1.F},
      {0.50F, 0.078F, 0.087F, 0.058F, 0.003F, 0.6F},
      {0.68F, 0.084F, 0.097F, 0.064F, 0.001F, 0.2F},
      {0.80F, 0.083F, 0.097F, 0.058F, -0.003F, 0.F},
      {0.90F, 0.070F, 0.082F, 0.043F, -0.006F, 0.F},
      {0.98F, 0.040F, 0.045F, 0.034F, -0.006F, 0.F},
  }};
  Limb trunk;
  const float length = m.neck - m.hip;
  for (const Ring& r : kRings) {
    const float thick = m.h * std::lerp(m.trunk, m.waist, r.waist) * (1.F - 0.05F * m.child);
    const float belly = std::max(0.F, m.waist - 1.F) * r.waist * 0.03F * m.h;  // fat is at the front
    trunk.stations.push_back({{0.F, m.hip + r.place * length, r.z * m.h + belly},
                              std::lerp(r.woman_wide, r.man_wide, m.male) * thick,
                              r.deep * thick,
                              0.02F * m.h});
  }
  trunk.stations = smoothed(trunk.stations);
  const float bottom = trunk.stations.front().centre.y();
  for (const Bone bone : {Bone::pelvis, Bone::spine, Bone::chest}) {
    const float at = f.bones[index(bone)].head.y() - bottom;
    trunk.bones.push_back({index(bone), bone == Bone::pelvis ? 0.F : at, 0.045F * m.h});
  }
  f.limbs.push_back(trunk);
  const float buttock = 0.046F * m.h * m.trunk;
  f.limbs.push_back(ellipsoid(Bone::pelvis, {0.046F * m.h, m.hip - 0.004F * m.h, -0.034F * m.h * m.trunk},
                              {buttock, buttock, 0.042F * m.h * m.trunk}, true));
  if (m.male < 0.5F && m.child < 0.4F) {
    const float size = 0.034F * m.h * m.trunk;
    f.limbs.push_back(ellipsoid(Bone::chest, {0.045F * m.h, m.hip + 0.64F * length, 0.048F * m.h * m.trunk},
                                {size, size, size}, true));
  }
}

void add_head(const Measures& m, BuiltinFigure& f) {
  const float neck = 0.034F * m.h * std::lerp(0.88F, 1.04F, m.male) * std::lerp(1.F, m.trunk, 0.5F);
  const BoneSegment& bone = f.bones[index(Bone::neck)];
  const float low = 0.02F * m.h;
  Limb throat{{{bone.head - Vector3f(0.F, low, 0.F), neck * 1.1F, neck * 1.1F, low}, {bone.tail, neck, neck, neck}},
              Vector3f::UnitX(),
              Vector3f::UnitY(),
              {{index(Bone::chest), 0.F, 0.F}, {index(Bone::neck), low, 0.02F * m.h}}};
  throat.bones.push_back({index(Bone::head), (bone.tail - bone.head).norm() + low * 0.7F, 0.02F * m.h});
  f.limbs.push_back(throat);
  const float s = m.head;
  const auto add = [&](const Vector3f& centre, const Vector3f& half_axes, bool paired = false) {
    const Vector3f at(centre.x() * s, m.chin + centre.y() * s, 0.008F * m.h + centre.z() * s);
    f.limbs.push_back(ellipsoid(Bone::head, at, s * half_axes, paired));
  };
  add({0.F, 0.62F, -0.02F}, {0.325F, 0.36F, 0.40F});           // skull
  add({0.F, 0.42F, 0.15F}, {0.255F, 0.36F, 0.245F});           // face
  add({0.F, 0.14F, 0.20F}, {0.16F, 0.12F, 0.17F});             // chin
  add({0.F, 0.37F, 0.44F}, {0.065F, 0.10F, 0.085F});           // nose
  add({0.335F, 0.45F, -0.02F}, {0.04F, 0.13F, 0.075F}, true);  // ears
}

void add_arm(const Measures& m, BuiltinFigure& f) {
  const auto bone = [&](Bone b) -> const BoneSegment& { return f.bones[index(b)]; };
  const float r = m.h * m.limb;
  const BoneSegment& collar = bone(Bone::l_clavicle);
  f.limbs.push_back(
      {{{collar.head, 0.030F * m.h, 0.030F * m.h, 0.02F * m.h}, {collar.tail, 0.029F * r, 0.029F * r, 0.024F * r}},
       Vector3f::UnitZ(),
       Vector3f::UnitX(),
       {{index(Bone::l_clavicle), 0.F, 0.F}},
       true});
  const Vector3f shoulder = bone(Bone::l_upper_arm).head;
  const auto ring = [&](float along, float wide, float deep) -> Station {
    return {shoulder + along * m.h * kDownArm, wide * r, deep * r, 0.02F * r};
  };
  Limb arm{{ring(0.F, 0.030F, 0.030F), ring(0.06F, 0.0295F, 0.028F), ring(0.12F, 0.0275F, 0.027F),
            ring(0.18F, 0.0245F, 0.0235F), ring(0.215F, 0.0255F, 0.025F), ring(0.27F, 0.0215F, 0.020F),
            ring(0.326F, 0.0170F, 0.0125F), ring(0.342F, 0.0170F, 0.0120F)},
           Vector3f::UnitZ(),
           kDownArm,
           {{index(Bone::l_upper_arm), 0.F, 0.F},
            {index(Bone::l_forearm), 0.18F * m.h, 0.026F * m.h},
            {index(Bone::l_hand), 0.326F * m.h, 0.014F * m.h}},
           true};
  arm.stations = smoothed(arm.stations);
  f.limbs.push_back(arm);
}

void add_hand(const Measures& m, BuiltinFigure& f) {
  const float r = m.h * std::sqrt(m.limb);
  const Vector3f wrist = f.bones[index(Bone::l_hand)].head;
  const auto ring = [&](float along, float wide, float deep, float z) -> Station {
    return {wrist + m.h * (along * kDownArm + Vector3f(0.F, 0.F, z)), wide * r, deep * r, 0.006F * r};
  };
  f.limbs.push_back(
      {{ring(0.006F, 0.0165F, 0.0105F, 0.F), ring(0.03F, 0.0225F, 0.0105F, 0.002F), ring(0.055F, 0.0235F, 0.0095F, 0.F),
        ring(0.08F, 0.0215F, 0.0080F, 0.F), ring(0.102F, 0.0150F, 0.0065F, 0.F)},
       Vector3f::UnitZ(),
       kDownArm,
       {{index(Bone::l_hand), 0.F, 0.F},
        {finger_bone(FingerBone::fingers, true), 0.046F * m.h, 0.008F * m.h},
        {finger_bone(FingerBone::finger_tips, true), 0.074F * m.h, 0.008F * m.h}},
       true});
  const BoneSegment& thumb = f.bones[finger_bone(FingerBone::thumb, true)];
  f.limbs.push_back(
      {{{thumb.head, 0.010F * r, 0.009F * r, 0.009F * r}, {thumb.tail, 0.0075F * r, 0.007F * r, 0.007F * r}},
       Vector3f::UnitZ(),
       kDownArm,
       {{finger_bone(FingerBone::thumb, true), 0.F, 0.F}},
       true});
}

void add_leg(const Measures& m, BuiltinFigure& f) {
  const float r = m.h * m.limb;
  const float thigh = m.hip - m.knee;
  const float shin = m.knee - m.ankle;
  const float outwards = std::lerp(0.004F, 0.F, m.male) * m.h;
  const auto ring = [&](float y, float wide, float deep, float z, float x = 0.F) -> Station {
    return {{leg_x(m, y) + x, y, z * m.h}, wide * r, deep * r, 0.02F * r};
  };
  Limb leg{
      {ring(m.hip - 0.01F * m.h, 0.049F, 0.053F, 0.F, outwards), ring(m.hip - 0.35F * thigh, 0.046F, 0.050F, 0.002F),
       ring(m.hip - 0.7F * thigh, 0.038F, 0.041F, 0.002F), ring(m.knee, 0.0325F, 0.036F, 0.F),
       ring(m.knee - 0.12F * shin, 0.0305F, 0.033F, -0.004F), ring(m.knee - 0.32F * shin, 0.0325F, 0.0345F, -0.008F),
       ring(m.knee - 0.7F * shin, 0.0225F, 0.0245F, -0.006F), ring(m.ankle + 0.01F * m.h, 0.0185F, 0.022F, -0.004F),
       ring(0.022F * m.h, 0.0185F, 0.022F, -0.004F)},
      Vector3f::UnitX(),
      Vector3f::UnitY(),
      {{index(Bone::l_thigh), 0.F, 0.F}},
      true};
  leg.stations = smoothed(leg.stations);
  const float top = m.hip - 0.01F * m.h;
  leg.bones.push_back({index(Bone::l_shin), top - m.knee, 0.036F * m.h});
  leg.bones.push_back({index(Bone::l_foot), top - m.ankle, 0.018F * m.h});
  f.limbs.push_back(leg);
  const float across = m.h * std::lerp(0.95F, 1.03F, m.male);
  const auto sole = [&](float z, float wide, float high) -> Station {
    // The height is the middle's; half an ellipse reaches below it.
    return {
        {leg_x(m, m.ankle) + 0.06F * (z + 0.03F) * m.h, high * m.h, z * m.h}, wide * across, high * m.h, 0.012F * m.h};
  };
  f.limbs.push_back({{sole(-0.028F, 0.0185F, 0.018F), sole(0.01F, 0.0195F, 0.022F), sole(0.055F, 0.0245F, 0.0165F),
                      sole(0.088F, 0.0250F, 0.0115F), sole(0.1F, 0.0210F, 0.010F)},
                     Vector3f::UnitX(),
                     Vector3f::UnitZ(),
                     {{index(Bone::l_foot), 0.F, 0.F}},
                     true});
}

}  // namespace

BuiltinFigure builtin_figure(const BuiltinShape& shape) {
  const Measures m = measure(shape);
  BuiltinFigure figure;
  figure.bones = builtin_bones(m);
  add_trunk(m, figure);
  add_head(m, figure);
  add_arm(m, figure);
  add_hand(m, figure);
  add_leg(m, figure);
  return figure;
}

}  // namespace vesalius::synth
