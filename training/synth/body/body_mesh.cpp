#include "synth/body/body_mesh.h"

#include <fmt/format.h>

#include <cmath>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr float kLargest_m = 100.F;

bool usable(const Eigen::Vector3f& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < kLargest_m; }

[[noreturn]] void fail(const std::string& what) { throw Error(fmt::format("body mesh: {}", what)); }

void check_sizes(const BodyMesh& mesh) {
  const BodyTopology& t = *mesh.topology;
  if (t.triangles.empty()) fail("no triangles, expected at least one");
  if (t.part.size() != t.triangles.size() || t.fabric.size() != t.triangles.size()) {
    fail(fmt::format("{} parts and {} fabrics, expected one for each of the {} triangles", t.part.size(),
                     t.fabric.size(), t.triangles.size()));
  }
  if (t.skin.size() != mesh.vertices.size()) {
    fail(fmt::format("{} skin weights, expected one for each of the {} vertices", t.skin.size(), mesh.vertices.size()));
  }
  if (t.body_triangles > t.triangles.size()) {
    fail(fmt::format("{} triangles of the body, expected at most {}", t.body_triangles, t.triangles.size()));
  }
}

void check_surface(const BodyMesh& mesh, const BodyModel& body) {
  const BodyTopology& topology = *mesh.topology;
  bool grounded = false;
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    for (const std::uint32_t v : topology.triangles[t]) {
      if (v >= mesh.vertices.size()) {
        fail(fmt::format("triangle {} uses vertex {}, expected 0 to {}", t, v, mesh.vertices.size() - 1));
      }
    }
    const int part = topology.part[t];
    if (part != kBackground && part >= body.part_count()) {
      fail(fmt::format("triangle {} has part {}, expected one below {}", t, part, body.part_count()));
    }
    grounded = grounded || part != kBackground;
    if (int(topology.fabric[t]) >= kFabricCount) fail(fmt::format("triangle {} has no fabric", t));
  }
  if (!grounded) fail("no triangle has a part, expected a person");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!usable(mesh.vertices[v])) fail(fmt::format("vertex {} is not finite or beyond 100 m", v));
  }
}

void check_skin(const BodyMesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const SkinWeights& skin = mesh.topology->skin[v];
    float sum = 0.F;
    for (std::size_t k = 0; k < 4; ++k) {
      if (skin.bone[k] >= mesh.rig.size()) {
        fail(fmt::format("vertex {} hangs on bone {}, expected 0 to {}", v, skin.bone[k], mesh.rig.size() - 1));
      }
      // Posing stops at the first zero, so a weight after it would be ignored.
      if (!(skin.weight[k] >= 0.F) || (k > 0 && skin.weight[k] > 0.F && skin.weight[k - 1] == 0.F)) {
        fail(fmt::format("vertex {}: expected weights from 0 to 1, zeros last", v));
      }
      sum += skin.weight[k];
    }
    if (!(std::abs(sum - 1.F) < 1e-3F)) {
      fail(fmt::format("vertex {}: its skin weights sum to {}, expected 1", v, sum));
    }
  }
}

void check_rig(const BodyMesh& mesh) {
  if (mesh.rig.empty()) fail("no rig bones, expected at least one");
  for (std::size_t b = 0; b < mesh.rig.size(); ++b) {
    const RigBone& bone = mesh.rig[b];
    const auto expect = [&](bool good, const char* what) {
      if (!good) fail(fmt::format("rig bone {} (\"{}\"): expected {}", b, bone.name, what));
    };
    expect(bone.parent >= -1 && bone.parent < int(b), "its parent before it");
    expect(usable(bone.head) && usable(bone.tail), "finite ends within 100 m");
    expect(index(bone.from) < kBoneCount && index(bone.to) < kBoneCount, "bones of the pose");
    expect(bone.blend >= 0.F && bone.blend <= 1.F, "a blend from 0 to 1");
    expect(std::abs(bone.t_from_rest.squaredNorm() - 1.F) < 1e-3F, "a rotation by a unit quaternion");
    expect(bone.grip == Grip::none || std::abs(bone.curl_axis.squaredNorm() - 1.F) < 1e-3F, "a unit axis");
    expect(std::isfinite(bone.curl_rad), "a finite angle");
  }
  for (const int bone : mesh.rig_of) {
    if (bone < 0 || bone >= int(mesh.rig.size())) {
      fail(fmt::format("a joint is the head of rig bone {}, expected 0 to {}", bone, mesh.rig.size() - 1));
    }
  }
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

void check(const BodyMesh& mesh, const BodyModel& body) {
  if (mesh.topology == nullptr) fail("no topology");
  check_sizes(mesh);
  check_rig(mesh);
  check_surface(mesh, body);
  check_skin(mesh);
  if (!(mesh.stature_m > 0.F && mesh.stature_m < kLargest_m)) {
    fail(fmt::format("stature {} m, expected one above 0", mesh.stature_m));
  }
}

}  // namespace vesalius::synth
