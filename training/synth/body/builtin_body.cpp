#include "synth/body/builtin_body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "synth/body/builtin_figure.h"
#include "synth/body/check_body.h"
#include "synth/body/surface_nets.h"
#include "synth/body/surface_parts.h"

namespace vesalius::synth {
namespace {

constexpr float kSoftness = 0.008F;  // share of the stature over which limbs melt into each other

/// Returns grid lines that are `step` apart, or `fine` apart between two coordinates.
std::vector<float> grid_lines(float from, float to, float step, float fine_from, float fine_to, float fine) {
  std::vector<float> lines;
  for (float x = from; x < to; x += x >= fine_from && x < fine_to ? fine : step) lines.push_back(x);
  return lines;
}

/// Returns a grid that is finer at the hands, which are far out along x, and at the head, which is at the top.
HalfGrid grid_around(const std::vector<Limb>& limbs, const BuiltinFigure& figure, float stature_m) {
  Bounds all = bounds(limbs.front());
  for (const Limb& limb : limbs) {
    const Bounds box = bounds(limb);
    all = {all.low.cwiseMin(box.low), all.high.cwiseMax(box.high)};
  }
  const float step = 0.0107F * stature_m;
  const float reach = 5.F * kSoftness * stature_m;
  const float wrist = figure.bones[index(Bone::l_hand)].head.x();
  const float head = figure.bones[index(Bone::head)].head.y();
  HalfGrid grid;
  grid.lines[0] = grid_lines(-step / 2.F, all.high.x() + reach, step, wrist - step, 9.F, 0.6F * step);
  grid.lines[1] = grid_lines(all.low.y() - reach, all.high.y() + reach, step, head - 3.F * step, 9.F, 0.75F * step);
  grid.lines[2] = grid_lines(all.low.z() - reach, all.high.z() + reach, step, 9.F, 9.F, step);
  return grid;
}

/// Returns the share of the bone that starts at `change`, in the blend with the previous bone.
float rising(float along_m, const BoneChange& change) {
  if (change.blend_m <= 0.F) return along_m >= change.from_m ? 1.F : 0.F;
  const float t = std::clamp((along_m - change.from_m) / (2.F * change.blend_m) + 0.5F, 0.F, 1.F);
  return t * t * (3.F - 2.F * t);
}

/// Returns the same bone on the other side.
int mirrored_bone(int bone) {
  if (bone < kBoneCount) return index(mirror(static_cast<Bone>(bone)));
  return bone < kBoneCount + 3 ? bone + 3 : bone - 3;
}

using Influences = std::array<float, kBuiltinBoneCount>;

void add_influence(const Limb& limb, const LimbPoint& at, float softness_m, bool in_mirror, Influences& out) {
  const float weight = std::exp(-std::max(at.distance_m, 0.F) / softness_m);
  for (std::size_t k = 0; k < limb.bones.size(); ++k) {
    const float begun = k == 0 ? 1.F : rising(at.along_m, limb.bones[k]);
    const float ended = k + 1 == limb.bones.size() ? 0.F : rising(at.along_m, limb.bones[k + 1]);
    const int bone = in_mirror ? mirrored_bone(limb.bones[k].bone) : limb.bones[k].bone;
    out[bone] += weight * std::max(begun - ended, 0.F);
  }
}

SkinWeights strongest(const Influences& influences) {
  SkinWeights skin;
  Influences left = influences;
  float sum = 0.F;
  const float least = 0.03F * *std::ranges::max_element(influences);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto best = std::ranges::max_element(left);
    if (k > 0 && *best < least) break;
    skin.bone[k] = static_cast<std::uint16_t>(best - left.begin());
    skin.weight[k] = *best;
    sum += *best;
    *best = -1.F;
  }
  for (float& w : skin.weight) w /= sum;
  return skin;
}

SkinWeights in_mirror(SkinWeights skin) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (skin.weight[k] > 0.F) skin.bone[k] = static_cast<std::uint16_t>(mirrored_bone(skin.bone[k]));
  }
  return skin;
}

/// Returns the weights of the half with x >= 0 by nearness to limbs, and their mirror images.
std::vector<SkinWeights> skin_weights(const std::vector<Limb>& limbs, const Surface& surface, float softness_m) {
  std::vector<SkinWeights> skin;
  const auto twins = std::ranges::find_if(surface.vertices, [](const auto& p) { return p.x() < 0.F; });
  std::vector<Bounds> boxes;
  std::vector<LimbDistance> distances;
  for (const Limb& limb : limbs) {
    boxes.push_back(bounds(limb));
    distances.emplace_back(limb);
  }
  for (auto p = surface.vertices.begin(); p != twins; ++p) {
    Influences influences{};
    for (std::size_t l = 0; l < limbs.size(); ++l) {
      for (const bool mirrored : {false, true}) {
        const float reach = 4.F * softness_m;
        const Eigen::Vector3f q(mirrored ? -p->x() : p->x(), p->y(), p->z());
        if (mirrored && !limbs[l].paired) continue;
        if ((q - boxes[l].low).minCoeff() < -reach || (boxes[l].high - q).minCoeff() < -reach) continue;
        add_influence(limbs[l], distances[l].nearest(q), softness_m, mirrored, influences);
      }
    }
    skin.push_back(strongest(influences));
  }
  const std::size_t half = skin.size();
  for (std::size_t v = 0; v < half; ++v) {
    if (surface.vertices[v].x() != 0.F) skin.push_back(in_mirror(skin[v]));
  }
  return skin;
}

RigBone finger(const BuiltinFigure& figure, FingerBone bone, bool left) {
  static constexpr std::array<const char*, 3> kNames = {"fingers", "finger_tips", "thumb"};
  static constexpr std::array<float, 3> kDegrees = {80.F, 95.F, 40.F};
  RigBone out;
  const Bone hand = left ? Bone::l_hand : Bone::r_hand;
  out.name = std::string(left ? "l_" : "r_") + kNames[static_cast<std::size_t>(bone)];
  out.parent = bone == FingerBone::finger_tips ? finger_bone(FingerBone::fingers, left) : index(hand);
  out.from = out.to = hand;
  out.grip = left ? Grip::left : Grip::right;
  out.curl_rad = kDegrees[static_cast<std::size_t>(bone)] * std::numbers::pi_v<float> / 180.F;
  const BoneSegment& palm = figure.bones[index(hand)];
  const Eigen::Vector3f along = (palm.tail - palm.head).normalized();
  // Palms face the thighs, and the thumb closes over them, across the fingers.
  const float inwards = left ? -1.F : 1.F;
  const Eigen::Vector3f palm_normal = (Eigen::Vector3f(inwards, 0.F, 0.F) - inwards * along.x() * along).normalized();
  const Eigen::Vector3f towards =
      bone == FingerBone::thumb ? Eigen::Vector3f(palm_normal - Eigen::Vector3f::UnitZ()) : palm_normal;
  const BoneSegment& own = figure.bones[finger_bone(bone, left)];
  out.curl_axis = (own.tail - own.head).cross(towards).normalized();
  return out;
}

/// Returns whether the bone's direction in the figure differs from the T: arms hang, and legs stand apart.
bool spread(Bone bone) {
  const Bone left = std::min(bone, mirror(bone));
  return left == Bone::l_upper_arm || left == Bone::l_forearm || left == Bone::l_hand || left == Bone::l_thigh ||
         left == Bone::l_shin;
}

std::vector<RigBone> make_rig(const BuiltinFigure& figure) {
  std::vector<RigBone> rig;
  for (int b = 0; b < kBoneCount; ++b) {
    const Bone bone = static_cast<Bone>(b);
    RigBone out;
    out.name = bone_name(bone);
    out.parent = bone == Bone::pelvis ? -1 : index(parent(bone));
    out.from = out.to = bone;
    rig.push_back(out);
  }
  for (const bool left : {true, false}) {
    for (const FingerBone bone : {FingerBone::fingers, FingerBone::finger_tips, FingerBone::thumb}) {
      rig.push_back(finger(figure, bone, left));
    }
  }
  for (std::size_t b = 0; b < rig.size(); ++b) {
    rig[b].head = figure.bones[b].head;
    rig[b].tail = figure.bones[b].tail;
    const Bone bone = rig[b].from;  // fingers turn with their hand
    if (!spread(bone)) continue;
    const BoneSegment& own = figure.bones[index(bone)];
    rig[b].t_from_rest = Eigen::Quaternionf::FromTwoVectors(own.tail - own.head, rest_direction(bone));
  }
  return rig;
}

}  // namespace

BodyMesh make_builtin_body(const BuiltinShape& shape, const BodyModel& body) {
  const float wanted_m = std::clamp(shape.stature_m, 0.9F, 2.2F);
  const BuiltinFigure figure = builtin_figure(shape);
  Surface surface = melt(figure.limbs, kSoftness * wanted_m, grid_around(figure.limbs, figure, wanted_m));
  BodyMesh mesh;
  auto topology = std::make_shared<BodyTopology>();
  topology->skin = skin_weights(figure.limbs, surface, 2.2F * kSoftness * wanted_m);
  mesh.rig = make_rig(figure);
  for (int b = 0; b < kBoneCount; ++b) mesh.rig_of[b] = b;
  const auto [low, high] = std::ranges::minmax(surface.vertices, {}, [](const Eigen::Vector3f& p) { return p.y(); });
  const float scale = wanted_m / (high.y() - low.y());  // melting and the grid shift sole and crown by some millimetres
  const auto placed = [&, bottom = low.y()](const Eigen::Vector3f& p) -> Eigen::Vector3f {
    return scale * Eigen::Vector3f(p.x(), p.y() - bottom, p.z());
  };
  for (Eigen::Vector3f& p : surface.vertices) p = placed(p);
  for (RigBone& bone : mesh.rig) {
    bone.head = placed(bone.head);
    bone.tail = placed(bone.tail);
  }
  mesh.vertices = std::move(surface.vertices);
  mesh.stature_m = wanted_m;
  topology->triangles = std::move(surface.triangles);
  topology->fabric.assign(topology->triangles.size(), Fabric::skin);
  topology->body_triangles = topology->triangles.size();
  mesh.topology = topology;
  topology->part = surface_parts(mesh, SurfaceParts(body));
  check(mesh, body);
  return mesh;
}

}  // namespace vesalius::synth
