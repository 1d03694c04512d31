#include "synth/body/surface_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

[[noreturn]] void fail(const BodyModel& body, int line, const std::string& what) {
  throw Error(fmt::format("body model {}:{}: surface: {}", body.name, line, what));
}

/// Returns the rules of a bone on one side and checks that they meet end to end.
std::vector<const SurfaceRule*> rules_of(const BodyModel& body, Bone bone, bool left) {
  std::vector<const SurfaceRule*> rules;
  for (const SurfaceRule& rule : body.surface) {
    const bool here = rule.side == SurfaceRule::Side::both || (rule.side == SurfaceRule::Side::left) == left;
    if (here && rule.bone == bone_name(bone)) rules.push_back(&rule);
  }
  std::ranges::stable_sort(rules, {}, &SurfaceRule::from);
  const char* side = left ? "left" : "right";
  float end = 0.F;
  int line = 0;
  for (const SurfaceRule* rule : rules) {
    if (rule->from != end) {
      fail(body, rule->line,
           fmt::format("on the {}, {} has {} from {} to {}", side, rule->bone,
                       rule->from > end ? "no part" : "two parts", std::min(end, rule->from),
                       std::max(end, rule->from)));
    }
    end = rule->to;
    line = rule->line;
  }
  if (end != 1.F) fail(body, line, fmt::format("on the {}, {} has no part from {} to 1", side, bone_name(bone), end));
  return rules;
}

/// The share of a vertex that moves with a bone, as an integer, so that the order of a triangle's corners does not
/// matter.
struct BoneWeight {
  Bone bone = Bone::pelvis;
  int weight = 0;
};
using VertexWeights = std::array<BoneWeight, 8>;

std::vector<VertexWeights> vertex_weights(const BodyMesh& mesh) {
  constexpr float kSteps = 4096.F;
  std::vector<VertexWeights> weights(mesh.topology->skin.size());
  for (std::size_t v = 0; v < weights.size(); ++v) {
    const SkinWeights& skin = mesh.topology->skin[v];
    for (std::size_t k = 0; k < 4; ++k) {
      const RigBone& bone = mesh.rig[skin.bone[k]];
      weights[v][2 * k] = {bone.from, int(std::lround(skin.weight[k] * (1.F - bone.blend) * kSteps))};
      weights[v][2 * k + 1] = {bone.to, int(std::lround(skin.weight[k] * bone.blend * kSteps))};
    }
  }
  return weights;
}

/// Returns the centre in double, in which sums of three floats are exact in any order.
Eigen::Vector3d centre(const BodyMesh& mesh, const Triangle& t) {
  return (mesh.vertices[t[0]].cast<double>() + mesh.vertices[t[1]].cast<double>() +
          mesh.vertices[t[2]].cast<double>()) /
         3.0;
}

/// Returns 1 for the bones of the middle and of one side, 0 for those of the other.
std::array<int, kBoneCount> of_side(char side) {
  std::array<int, kBoneCount> own{};
  for (int b = 0; b < kBoneCount; ++b) {
    const Bone bone = static_cast<Bone>(b);
    own[b] = bone == mirror(bone) || bone_name(bone).starts_with(side) ? 1 : 0;
  }
  return own;
}

/// Returns the bone with which most of a triangle moves; of equal ones that of its own side.
Bone favoured_bone(const std::vector<VertexWeights>& weights, const Triangle& triangle, bool left) {
  static const std::array<std::array<int, kBoneCount>, 2> own{of_side('r'), of_side('l')};
  std::array<int, kBoneCount> ranks = own[left ? 1 : 0];
  for (const std::uint32_t v : triangle) {
    for (const BoneWeight& w : weights[v]) ranks[index(w.bone)] += 2 * w.weight;
  }
  return static_cast<Bone>(std::ranges::max_element(ranks) - ranks.begin());  // the first of equal ones
}

float place_along(const BoneSegment& bone, const Eigen::Vector3d& p) {
  const Eigen::Vector3d head = bone.head.cast<double>();
  const Eigen::Vector3d axis = bone.tail.cast<double>() - head;
  const double length2 = axis.squaredNorm();
  return length2 > 0.0 ? float((p - head).dot(axis) / length2) : 0.F;
}

}  // namespace

SurfaceParts::SurfaceParts(const BodyModel& body) {
  if (body.surface.empty()) {
    throw Error(
        fmt::format("body model {}: no [[surface]] rules, expected some to label synthetic people by", body.name));
  }
  for (const SurfaceRule& rule : body.surface) {
    if (find_bone(rule.bone) < 0) fail(body, rule.line, fmt::format("no bone is called \"{}\"", rule.bone));
  }
  for (int b = 0; b < kBoneCount; ++b) {
    for (const bool left : {false, true}) {
      for (const SurfaceRule* rule : rules_of(body, static_cast<Bone>(b), left)) {
        stretches_[b][left ? 1 : 0].push_back({rule->to, static_cast<std::uint8_t>(rule->part)});
      }
    }
  }
}

std::uint8_t SurfaceParts::part(Bone bone, float along, bool left) const {
  const std::vector<Stretch>& stretches = stretches_[index(bone)][left ? 1 : 0];
  const auto found = std::ranges::find_if(stretches, [&](const Stretch& s) { return along < s.to; });
  return found == stretches.end() ? stretches.back().part : found->part;
}

std::vector<Bone> surface_bones(const BodyMesh& mesh) {
  std::vector<Bone> bones;
  bones.reserve(mesh.topology->triangles.size());
  const std::vector<VertexWeights> weights = vertex_weights(mesh);
  for (const Triangle& t : mesh.topology->triangles)
    bones.push_back(favoured_bone(weights, t, centre(mesh, t).x() > 0.0));
  return bones;
}

std::vector<std::uint8_t> surface_parts(const BodyMesh& mesh, const SurfaceParts& rules) {
  const auto segments = rest_bones(mesh);
  const std::vector<Bone> bones = surface_bones(mesh);
  std::vector<std::uint8_t> parts;
  parts.reserve(bones.size());
  for (std::size_t t = 0; t < bones.size(); ++t) {
    const Eigen::Vector3d middle = centre(mesh, mesh.topology->triangles[t]);
    const float along = place_along(segments[index(bones[t])], middle);
    parts.push_back(rules.part(bones[t], along, middle.x() > 0.0));
  }
  return parts;
}

}  // namespace vesalius::synth
