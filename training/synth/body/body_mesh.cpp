#include "synth/body/body_mesh.h"

#include <utility>

namespace vesalius::synth {

namespace {

Eigen::Vector3f in_mirror(const Eigen::Vector3f& p) { return {-p.x(), p.y(), p.z()}; }

/// Returns the name of the same thing on the other side, for names such as "wrist.L" and "l_hand".
std::string name_in_mirror(std::string name) {
  const auto swap = [](char& c, char l, char r) { c = c == l ? r : c == r ? l : c; };
  if (name.starts_with("l_") || name.starts_with("r_")) swap(name.front(), 'l', 'r');
  if (name.ends_with(".L") || name.ends_with(".R")) swap(name.back(), 'L', 'R');
  return name;
}

RigBone in_mirror(const RigBone& bone) {
  RigBone out = bone;
  out.name = name_in_mirror(bone.name);
  out.head = in_mirror(bone.head);
  out.tail = in_mirror(bone.tail);
  out.from = mirror(bone.from);
  out.to = mirror(bone.to);
  const Eigen::Quaternionf& q = bone.t_from_rest;
  out.t_from_rest = Eigen::Quaternionf(q.w(), q.x(), -q.y(), -q.z());
  out.grip = bone.grip == Grip::left ? Grip::right : bone.grip == Grip::right ? Grip::left : Grip::none;
  out.curl_axis = -in_mirror(bone.curl_axis);  // an axis is a pseudo-vector
  return out;
}

}  // namespace

Bone next_bone(Bone bone) {
  switch (bone) {
    case Bone::head:
    case Bone::l_hand:
    case Bone::r_hand:
    case Bone::l_foot:
    case Bone::r_foot:
      return bone;
    default:
      return static_cast<Bone>(index(bone) + 1);
  }
}

std::array<BoneSegment, kBoneCount> rest_bones(const BodyMesh& mesh) {
  std::array<BoneSegment, kBoneCount> segments;
  const auto rig_bone = [&](Bone bone) -> const RigBone& { return mesh.rig[mesh.rig_of[index(bone)]]; };
  for (int b = 0; b < kBoneCount; ++b) {
    const Bone bone = static_cast<Bone>(b);
    const Bone after = next_bone(bone);
    segments[b] = {rig_bone(bone).head, after == bone ? rig_bone(bone).tail : rig_bone(after).head};
  }
  return segments;
}

BodyMesh mirrored(const BodyMesh& mesh, const BodyModel& body) {
  BodyMesh out = mesh;
  auto topology = std::make_shared<BodyTopology>(*mesh.topology);
  for (Triangle& t : topology->triangles) std::swap(t[0], t[2]);  // keeps the orientation
  for (std::uint8_t& part : topology->part) {
    if (part != kBackground) part = static_cast<std::uint8_t>(body.parts[part].mirror);
  }
  out.topology = std::move(topology);
  for (Eigen::Vector3f& p : out.vertices) p = in_mirror(p);
  for (RigBone& bone : out.rig) bone = in_mirror(bone);
  for (int b = 0; b < kBoneCount; ++b) {
    out.rig_of[index(mirror(static_cast<Bone>(b)))] = mesh.rig_of[b];
  }
  return out;
}

}  // namespace vesalius::synth
