#include "synth/body/builtin_measures.h"

#include <algorithm>
#include <cmath>

namespace vesalius::synth {

using Eigen::Vector3f;

Measures measure(const BuiltinShape& shape) {
  Measures m;
  m.h = std::clamp(shape.stature_m, 0.9F, 2.2F);
  m.male = std::clamp(shape.maleness, 0.F, 1.F);
  m.child = std::clamp((18.F - shape.age_years) / 14.F, 0.F, 1.F);
  const float build = std::clamp(shape.build, -1.F, 1.F);
  m.limb = (1.F + (build > 0.F ? 0.28F : 0.16F) * build) * std::lerp(0.94F, 1.02F, m.male) * (1.F - 0.02F * m.child);
  m.trunk = 1.F + (build > 0.F ? 0.2F : 0.1F) * build;
  m.waist = 1.F + (build > 0.F ? 0.5F : 0.14F) * build + 0.1F * m.child;
  // The head takes 13 % of an adult's stature and 17.5 % of a four-year-old's, whose legs are shorter in turn (Drillis
  // and Contini; WHO 2006).
  m.head = std::lerp(0.130F, 0.178F, m.child) * m.h;
  m.chin = m.h - m.head;
  m.neck = m.chin - 0.022F * m.h;
  m.shoulder = m.chin - 0.058F * m.h;
  m.hip = std::lerp(0.520F, 0.465F, m.child) * m.h;
  m.knee = std::lerp(0.285F, 0.255F, m.child) * m.h;
  m.ankle = 0.039F * m.h;
  m.shoulder_x = std::lerp(0.099F, 0.109F, m.male) * m.h * (1.F - 0.06F * m.child);
  m.hip_x = std::lerp(0.058F, 0.053F, m.male) * m.h * std::sqrt(m.trunk);
  return m;
}

namespace {

using Bones = std::array<BoneSegment, kBuiltinBoneCount>;

void set(Bones& bones, Bone bone, const Vector3f& head, const Vector3f& tail) { bones[index(bone)] = {head, tail}; }

void add_bones(const Measures& m, Bones& bones) {
  const float pelvis = m.hip + 0.014F * m.h;
  const float back = m.neck - pelvis;
  const Vector3f root(0.F, pelvis, 0.F);
  const Vector3f spine(0.F, pelvis + 0.09F * back, 0.F);
  const Vector3f chest(0.F, pelvis + 0.4F * back, 0.F);
  const Vector3f neck(0.F, m.neck, -0.004F * m.h);
  const Vector3f head(0.F, m.chin + 0.33F * m.head, 0.006F * m.h);
  set(bones, Bone::pelvis, root, spine);
  set(bones, Bone::spine, spine, chest);
  set(bones, Bone::chest, chest, neck);
  set(bones, Bone::neck, neck, head);
  set(bones, Bone::head, head, {0.F, m.h, 0.006F * m.h});
  const Vector3f shoulder(m.shoulder_x, m.shoulder, -0.003F * m.h);
  const Vector3f elbow = shoulder + 0.180F * m.h * kDownArm;
  const Vector3f wrist = elbow + 0.146F * m.h * kDownArm;
  set(bones, Bone::l_clavicle, {0.015F * m.h, m.shoulder, 0.015F * m.h}, shoulder);
  set(bones, Bone::l_upper_arm, shoulder, elbow);
  set(bones, Bone::l_forearm, elbow, wrist);
  set(bones, Bone::l_hand, wrist, wrist + 0.108F * m.h * kDownArm);
  const Vector3f knee(leg_x(m, m.knee), m.knee, 0.F);
  const Vector3f ankle(leg_x(m, m.ankle), m.ankle, -0.004F * m.h);
  set(bones, Bone::l_thigh, {m.hip_x, m.hip, 0.F}, knee);
  set(bones, Bone::l_shin, knee, ankle);
  set(bones, Bone::l_foot, ankle, {ankle.x() + 0.008F * m.h, 0.012F * m.h, 0.107F * m.h});
  const auto finger = [&](FingerBone bone, const Vector3f& from, const Vector3f& to) {
    bones[finger_bone(bone, true)] = {from, to};
  };
  const Vector3f knuckles = wrist + 0.052F * m.h * kDownArm;
  const Vector3f middle = wrist + 0.080F * m.h * kDownArm;
  finger(FingerBone::fingers, knuckles, middle);
  finger(FingerBone::finger_tips, middle, wrist + 0.108F * m.h * kDownArm);
  finger(FingerBone::thumb, wrist + m.h * (0.016F * kDownArm + Vector3f(0.F, 0.F, 0.014F)),
         wrist + m.h * (0.056F * kDownArm + Vector3f(0.F, 0.F, 0.042F)));
}

/// Adds the right bones as mirror images of the left ones.
void add_right_bones(Bones& bones) {
  const auto in_mirror = [](const BoneSegment& s) -> BoneSegment {
    return {{-s.head.x(), s.head.y(), s.head.z()}, {-s.tail.x(), s.tail.y(), s.tail.z()}};
  };
  for (int b = 0; b < kBoneCount; ++b) {
    const Bone other = mirror(static_cast<Bone>(b));
    if (bone_name(static_cast<Bone>(b)).starts_with("r_")) {
      bones[b] = in_mirror(bones[index(other)]);
    }
  }
  for (const FingerBone bone : {FingerBone::fingers, FingerBone::finger_tips, FingerBone::thumb}) {
    bones[finger_bone(bone, false)] = in_mirror(bones[finger_bone(bone, true)]);
  }
}

}  // namespace

std::array<BoneSegment, kBuiltinBoneCount> builtin_bones(const Measures& m) {
  Bones bones;
  add_bones(m, bones);
  add_right_bones(bones);
  return bones;
}

}  // namespace vesalius::synth
