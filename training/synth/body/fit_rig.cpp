#include "synth/body/fit_rig.h"

#include <fmt/format.h>

#include <algorithm>

#include "synth/text/text_scanner.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

int find(const std::vector<SkeletonBone>& skeleton, const std::string& name, const RigMap& map) {
  const auto found = std::ranges::find(skeleton, name, &SkeletonBone::name);
  if (found == skeleton.end()) {
    throw Error(fmt::format("{}: the skeleton has no bone \"{}\"", map.name, shown(name)));
  }
  return int(found - skeleton.begin());
}

void map_follows(const std::vector<SkeletonBone>& skeleton, const RigMap& map, std::vector<RigBone>& bones) {
  std::vector<const RigMap::Follow*> follows(skeleton.size(), nullptr);
  for (const RigMap::Follow& f : map.follows) follows[find(skeleton, f.rig, map)] = &f;
  for (std::size_t b = 0; b < skeleton.size(); ++b) {
    RigBone& bone = bones[b];
    bone.name = skeleton[b].name;
    bone.parent = skeleton[b].parent;
    if (follows[b] != nullptr) {
      bone.from = follows[b]->from;
      bone.to = follows[b]->to;
      bone.blend = follows[b]->blend;
      bone.twist_only = follows[b]->twist;
    } else if (bone.parent >= 0) {
      const RigBone& above = bones[bone.parent];
      bone.from = above.from;
      bone.to = above.to;
      bone.blend = above.blend;
      bone.twist_only = above.twist_only;
    } else {
      throw Error(fmt::format("{}: no [[follow]] for the root \"{}\"", map.name, shown(bone.name)));
    }
  }
}

/// Returns the turns from this body's rest pose to the T for each bone of the poses.
std::array<Eigen::Quaternionf, kBoneCount> rest_turns(const MappedRig& rig, const std::vector<Eigen::Vector3f>& heads,
                                                      const std::vector<Eigen::Vector3f>& tails) {
  std::array<Eigen::Quaternionf, kBoneCount> turns;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const Bone bone = static_cast<Bone>(b);
    const Eigen::Quaternionf above = bone == Bone::pelvis ? Eigen::Quaternionf::Identity() : turns[index(parent(bone))];
    turns[b] = rig.rest[b] == RigMap::Rest::keep ? Eigen::Quaternionf::Identity() : above;
    if (rig.rest[b] != RigMap::Rest::straighten) continue;
    const Eigen::Vector3f& head = heads[rig.rig_of[b]];
    const Eigen::Vector3f& tail = rig.tail_of[b] < 0 ? heads[rig.rig_of[b + 1]] : tails[rig.tail_of[b]];
    turns[b] = Eigen::Quaternionf::FromTwoVectors(above * (tail - head), rest_direction(bone)) * above;
  }
  return turns;
}

/// Returns the axis about which a finger bone turns towards the palm.
Eigen::Vector3f curl_axis(const MappedRig& rig, const MappedRig::Finger& finger,
                          const std::vector<Eigen::Vector3f>& heads, const std::vector<Eigen::Vector3f>& tails) {
  const int b = finger.bone;
  const bool left = rig.bones[b].grip == Grip::left;
  const auto head = [&](int bone) -> const Eigen::Vector3f& { return heads[bone]; };
  const Eigen::Vector3f wrist = head(rig.rig_of[index(left ? Bone::l_hand : Bone::r_hand)]);
  const Eigen::Vector3f first = head(rig.first_knuckle[left ? 0 : 1]);
  const Eigen::Vector3f across = (head(rig.last_knuckle[left ? 0 : 1]) - first).normalized();
  const Eigen::Vector3f along = first - wrist;
  const Eigen::Vector3f palm = (left ? across.cross(along) : along.cross(across)).normalized();
  const Eigen::Vector3f axis = (tails[b] - heads[b]).cross(palm + finger.across * across);
  return axis.norm() > 1e-9F ? Eigen::Vector3f(axis.normalized()) : Eigen::Vector3f::UnitZ();
}

}  // namespace

MappedRig map_rig(const std::vector<SkeletonBone>& skeleton, const RigMap& map) {
  MappedRig rig;
  rig.bones.resize(skeleton.size());
  map_follows(skeleton, map, rig.bones);
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    rig.rig_of[b] = find(skeleton, map.bones[b].joint, map);
    rig.tail_of[b] = map.bones[b].tail.empty() ? -1 : find(skeleton, map.bones[b].tail, map);
    rig.rest[b] = map.bones[b].rest;
  }
  for (const RigMap::Finger& finger : map.fingers) {
    const int bone = find(skeleton, finger.rig, map);
    rig.bones[bone].grip = finger.hand;
    rig.bones[bone].curl_rad = finger.radians;
    rig.fingers.push_back({bone, finger.across});
  }
  if (map.fingers.empty()) return rig;
  for (std::size_t side = 0; side < 2; ++side) {
    rig.first_knuckle[side] = find(skeleton, map.first_knuckle[side], map);
    rig.last_knuckle[side] = find(skeleton, map.last_knuckle[side], map);
  }
  return rig;
}

std::vector<RigBone> fit_rig(const MappedRig& rig, const std::vector<Eigen::Vector3f>& heads,
                             const std::vector<Eigen::Vector3f>& tails) {
  const auto turns = rest_turns(rig, heads, tails);
  std::vector<RigBone> bones = rig.bones;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    bones[b].head = heads[b];
    bones[b].tail = tails[b];
    const Eigen::Quaternionf& from = turns[index(bones[b].from)];
    bones[b].t_from_rest = from.slerp(bones[b].blend, turns[index(bones[b].to)]);
  }
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    if (rig.tail_of[b] >= 0) {
      bones[rig.rig_of[b]].tail = tails[rig.tail_of[b]];
    }
  }
  for (const MappedRig::Finger& finger : rig.fingers) {
    bones[finger.bone].curl_axis = curl_axis(rig, finger, heads, tails);
  }
  return bones;
}

}  // namespace vesalius::synth
