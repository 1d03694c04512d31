#include "synth/dress/dress.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/body/body_mesh.h"
#include "synth/body/surface_parts.h"
#include "synth/dress/wardrobe.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.F, 1.F);
  return t * t * (3.F - 2.F * t);
}

std::vector<Vector3f> vertex_normals(const BodyMesh& mesh) {
  std::vector<Vector3f> normals(mesh.vertices.size(), Vector3f::Zero());
  for (const Triangle& t : mesh.topology->triangles) {
    const Vector3f& a = mesh.vertices[t[0]];
    const Vector3f normal = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
    for (const std::uint32_t v : t) normals[v] += normal;
  }
  for (Vector3f& n : normals) n = n.norm() > 0.F ? Vector3f(n.normalized()) : Vector3f::Zero();
  return normals;
}

/// Long waves over the body, -1 to 1, by which the thickness of cloth varies.
class Folds {
 public:
  explicit Folds(Random& random) {
    for (Wave& wave : waves_) {
      const auto length_m = float(random.uniform(0.08, 0.25));
      const auto direction = float(random.uniform(-1.0, 1.0));
      const auto round = float(random.uniform(0.0, 2.0 * std::numbers::pi));
      const float level = std::sqrt(1.F - direction * direction);
      const float number = 2.F * std::numbers::pi_v<float> / length_m;
      wave.k = number * Vector3f(level * std::cos(round), direction, level * std::sin(round));
      wave.phase = float(random.uniform(0.0, 2.0 * std::numbers::pi));
    }
  }
  float operator()(const Vector3f& p) const {
    float sum = 0.F;
    for (const Wave& wave : waves_) sum += std::sin(wave.k.dot(p) + wave.phase);
    return sum / float(waves_.size());
  }

 private:
  struct Wave {
    Vector3f k;
    float phase;
  };
  std::array<Wave, 5> waves_{};
};

/// The places where an outfit covers the bare body.
class Cover {
 public:
  Cover(const BodyMesh& mesh, const Outfit& outfit) : outfit_(outfit), bones_(rest_bones(mesh)) {}

  /// Returns the fabric at a place near a bone.
  Fabric fabric(Bone bone, const Vector3f& p) const {
    switch (bone) {
      case Bone::pelvis:
        return Fabric::bottom;
      case Bone::head:
        return outfit_.hair != Hair::bald && scalp(p) > 0.5F ? Fabric::hair : Fabric::skin;
      case Bone::neck:
      case Bone::l_hand:
      case Bone::r_hand:
        return Fabric::skin;
      case Bone::l_foot:
      case Bone::r_foot:
        return outfit_.shoes ? Fabric::shoes : Fabric::skin;
      case Bone::l_upper_arm:
      case Bone::r_upper_arm:
      case Bone::l_forearm:
      case Bone::r_forearm:
        return limb_share(bone, p) < outfit_.sleeves ? Fabric::top : Fabric::skin;
      case Bone::l_thigh:
      case Bone::r_thigh:
      case Bone::l_shin:
      case Bone::r_shin:
        return limb_share(bone, p) < outfit_.legs ? Fabric::bottom : Fabric::skin;
      default:
        return Fabric::top;
    }
  }

  /// Returns the distance of the surface from the skin before folds are added.
  float thickness(Bone bone, const Vector3f& p) const {
    if (bone == Bone::head) return outfit_.hair_m * scalp(p);
    switch (fabric(bone, p)) {
      case Fabric::top:
        return outfit_.top_m;
      case Fabric::bottom:
        return outfit_.bottom_m;
      case Fabric::shoes:
        return 0.006F;
      default:
        return 0.F;
    }
  }

 private:
  float along(Bone bone, const Vector3f& p) const {
    const BoneSegment& s = bones_[index(bone)];
    const Vector3f axis = s.tail - s.head;
    return (p - s.head).dot(axis) / std::max(axis.squaredNorm(), 1e-9F);
  }

  /// Returns the place along a limb: 0 at shoulder or hip, 0.5 at elbow or knee, 1 at wrist or ankle.
  float limb_share(Bone bone, const Vector3f& p) const {
    const bool lower =
        bone == Bone::l_forearm || bone == Bone::r_forearm || bone == Bone::l_shin || bone == Bone::r_shin;
    return 0.5F * (std::clamp(along(bone, p), 0.F, 0.99F) + (lower ? 1.F : 0.F));
  }

  /// Returns 1 on the part of the head where hair grows and 0 on the face.
  float scalp(const Vector3f& p) const {
    const BoneSegment& head = bones_[index(Bone::head)];
    const float size = (head.tail - head.head).norm();
    const float up = (p.y() - head.head.y()) / size;
    const float front = (p.z() - head.head.z()) / size;
    // This is the hairline from the nape past the ears to the forehead, in lengths of the head's bone.
    const float line = front < 0.1F ? std::lerp(-0.4F, 0.15F, smooth_step(-0.7F, 0.1F, front))
                                    : std::lerp(0.15F, 0.72F, smooth_step(0.1F, 0.9F, front));
    return smooth_step(line - 0.06F, line + 0.12F, up);
  }

  const Outfit& outfit_;
  std::array<BoneSegment, kBoneCount> bones_;
};

/// Moves the skin along its normals by the thickness of cloth and hair.
void put_on_clothes(const BodyMesh& bare, const Outfit& outfit, Random& random, BodyMesh& out) {
  const Cover cover(bare, outfit);
  const Folds folds(random);
  const std::vector<Vector3f> normals = vertex_normals(bare);
  const float thickest = std::max({outfit.top_m, outfit.bottom_m, outfit.hair_m});
  for (std::size_t v = 0; v < bare.vertices.size(); ++v) {
    const Vector3f& p = bare.vertices[v];
    const SkinWeights& skin = bare.topology->skin[v];
    float lift = 0.F;
    for (std::size_t k = 0; k < 4; ++k) {
      if (skin.weight[k] == 0.F) continue;
      const RigBone& bone = bare.rig[skin.bone[k]];
      lift += skin.weight[k] * (1.F - bone.blend) * cover.thickness(bone.from, p);
      if (bone.blend > 0.F) lift += skin.weight[k] * bone.blend * cover.thickness(bone.to, p);
    }
    lift *= 1.F + outfit.folds * folds(p);
    out.vertices[v] = p + std::clamp(lift, 0.F, std::max(thickest, 0.006F)) * normals[v];
  }
}

std::vector<Fabric> fabrics(const BodyMesh& bare, const Outfit& outfit) {
  const Cover cover(bare, outfit);
  const std::vector<Bone> bones = surface_bones(bare);
  std::vector<Fabric> fabric;
  fabric.reserve(bones.size());
  for (std::size_t t = 0; t < bones.size(); ++t) {
    const Triangle& tri = bare.topology->triangles[t];
    const Vector3f centre = (bare.vertices[tri[0]] + bare.vertices[tri[1]] + bare.vertices[tri[2]]) / 3.F;
    fabric.push_back(cover.fabric(bones[t], centre));
  }
  return fabric;
}

}  // namespace

BodyMesh dress(const BodyMesh& mesh, const Outfit& outfit, const BodyModel& body, Random& random) {
  if (mesh.topology->body_triangles != mesh.topology->triangles.size()) throw Error("dress: expected a bare body");
  BodyMesh out = mesh;
  auto topology = std::make_shared<BodyTopology>(*mesh.topology);
  out.topology = topology;
  topology->fabric = fabrics(mesh, outfit);
  put_on_clothes(mesh, outfit, random, out);
  Wardrobe wardrobe(out, *topology, SurfaceParts(body));
  if (outfit.hair == Hair::long_hair) wardrobe.add_long_hair(outfit.hair_m, random);
  if (outfit.skirt > 0.F) wardrobe.add_skirts(outfit.skirt, Fabric::bottom, random);
  if (outfit.coat > 0.F) wardrobe.add_skirts(outfit.coat, Fabric::top, random);
  if (outfit.hat != Hat::none) wardrobe.add_hat(outfit.hat, random);
  if (outfit.backpack) wardrobe.add_backpack(random);
  if (outfit.bag != Bag::none) wardrobe.add_bag(outfit.bag, outfit.left_hand, random);
  if (outfit.held != Held::none) wardrobe.add_held(outfit.held, !outfit.left_hand, random);
  check(out, body);
  return out;
}

}  // namespace vesalius::synth
