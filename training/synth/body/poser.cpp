#include "synth/body/poser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// The zeroth and first moment of the volume that each bone carries.
class Moments {
 public:
  explicit Moments(const BodyMesh& mesh)
      : skin_(mesh.topology->skin), volume_(mesh.rig.size(), 0.0), first_(mesh.rig.size(), Eigen::Vector3d::Zero()) {}

  /// Adds the tetrahedron between a triangle and the origin, which moves as those vertices do in the mean.
  void add(const std::array<Eigen::Vector3d, 3>& p, std::span<const std::uint32_t> vertices) {
    const double volume = p[0].dot(p[1].cross(p[2])) / 6.0;
    const Eigen::Vector3d centre = (p[0] + p[1] + p[2]) / 4.0;
    const float scale = 1.F / float(vertices.size());
    for (const std::uint32_t v : vertices) {
      for (std::size_t k = 0; k < 4; ++k) {
        if (skin_[v].weight[k] <= 0.F) continue;
        const float weight = skin_[v].weight[k] * scale;
        volume_[skin_[v].bone[k]] += volume * weight;
        first_[skin_[v].bone[k]] += volume * weight * centre;
      }
    }
  }

  void write(int part, const Eigen::Vector3d& origin, std::vector<PartShare>& out) const {
    const double total = std::accumulate(volume_.begin(), volume_.end(), 0.0);
    if (!(total > 1e-9)) return;  // below a cubic millimetre the centre is not defined well
    for (std::size_t bone = 0; bone < volume_.size(); ++bone) {
      if (volume_[bone] == 0.0 && first_[bone].isZero(0.0)) continue;
      const double share = volume_[bone] / total;
      const Eigen::Vector3d moment = first_[bone] / total + share * origin;
      out.push_back({part, int(bone), float(share), moment.cast<float>()});
    }
  }

 private:
  const std::vector<SkinWeights>& skin_;
  std::vector<double> volume_;
  std::vector<Eigen::Vector3d> first_;
};

/// Returns the reversed edges that only one triangle of the part uses. They are the rims of the lids that close it.
std::vector<Edge> open_edges(const BodyMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  std::vector<Edge> edges;
  for (const std::uint32_t t : triangles) {
    const Triangle& tri = mesh.topology->triangles[t];
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(tri[k], tri[(k + 1) % 3]);
  }
  std::ranges::sort(edges);
  std::vector<Edge> open;
  for (const Edge& e : edges) {
    if (!std::ranges::binary_search(edges, Edge{e.second, e.first})) open.emplace_back(e.second, e.first);
  }
  return open;
}

/// Groups connected edges to rims, each with the mean of its points.
class Rims {
 public:
  Rims(const BodyMesh& mesh, const std::vector<Edge>& edges) {
    for (const auto& [a, b] : edges) unite(a, b);
    for (const auto& edge : edges) {
      auto& [sum, count] = sums_[find(edge.first)];
      sum += mesh.vertices[edge.first].cast<double>() + mesh.vertices[edge.second].cast<double>();
      count += 2;
    }
  }
  Eigen::Vector3d middle(std::uint32_t vertex) {
    const auto& [sum, count] = sums_.at(find(vertex));
    return sum / count;
  }

 private:
  struct Sum {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
  };
  std::uint32_t find(std::uint32_t v) {
    auto at = parent_.try_emplace(v, v).first;
    while (at->second != at->first) {
      const auto up = parent_.find(at->second);
      at->second = up->second;  // halves the path for the next search
      at = up;
    }
    return at->first;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t root = find(b);
    parent_[find(a)] = root;
  }

  std::map<std::uint32_t, std::uint32_t> parent_;
  std::map<std::uint32_t, Sum> sums_;
};

void add_part(const BodyMesh& mesh, int part, const std::vector<std::uint32_t>& triangles,
              std::vector<PartShare>& out) {
  const auto point = [&](std::uint32_t v) -> Eigen::Vector3d { return mesh.vertices[v].cast<double>(); };
  // The point that all tetrahedra share does not affect the part's volume, but it affects how bones share it. So it is
  // a point in the middle of the part that does not depend on the order of corners.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  for (const std::uint32_t t : triangles) {
    for (const std::uint32_t v : mesh.topology->triangles[t]) origin += point(v);
  }
  origin /= 3.0 * double(triangles.size());
  Moments moments(mesh);
  for (const std::uint32_t t : triangles) {
    const Triangle& tri = mesh.topology->triangles[t];
    moments.add({point(tri[0]) - origin, point(tri[1]) - origin, point(tri[2]) - origin}, tri);
  }
  const std::vector<Edge> open = open_edges(mesh, triangles);
  Rims rims(mesh, open);
  for (const auto& [a, b] : open) {
    moments.add({point(a) - origin, point(b) - origin, rims.middle(a) - origin}, std::array<std::uint32_t, 2>{a, b});
  }
  moments.write(part, origin, out);
}

/// The rows of the 3x4 matrix that moves a point from rest to the pose.
using Placement = std::array<float, 12>;

Placement placement(const Eigen::Quaternionf& rotation, const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
  const Eigen::Matrix3f r = rotation.toRotationMatrix();
  const Eigen::Vector3f t = to - r * from;
  return {r(0, 0), r(0, 1), r(0, 2), t.x(), r(1, 0), r(1, 1), r(1, 2), t.y(), r(2, 0), r(2, 1), r(2, 2), t.z()};
}

Eigen::Vector3f moved(const Placement& m, const Eigen::Vector3f& p, float one = 1.F) {
  return {m[0] * p.x() + m[1] * p.y() + m[2] * p.z() + m[3] * one,
          m[4] * p.x() + m[5] * p.y() + m[6] * p.z() + m[7] * one,
          m[8] * p.x() + m[9] * p.y() + m[10] * p.z() + m[11] * one};
}

/// Returns `share` of the turn from one bone to the other about the first one's axis.
Eigen::Quaternionf shared_twist(const Eigen::Quaternionf& from, const Eigen::Quaternionf& to,
                                const Eigen::Vector3f& axis, float share) {
  const Eigen::Quaternionf turn = from.conjugate() * to;
  const float along = turn.vec().dot(axis);
  if (std::hypot(turn.w(), along) < 1e-4F) return from;  // the axis is reversed, so the twist is undefined
  const float angle = 2.F * std::atan2(turn.w() < 0.F ? -along : along, std::abs(turn.w()));
  return from * Eigen::Quaternionf(Eigen::AngleAxisf(share * angle, axis));
}

Eigen::Quaternionf blended(const RigBone& bone, const std::array<Eigen::Quaternionf, kBoneCount>& world) {
  const Eigen::Quaternionf& from = world[index(bone.from)];
  if (bone.blend == 0.F) return from;
  const Eigen::Quaternionf& to = world[index(bone.to)];
  if (bone.twist_only) return shared_twist(from, to, rest_direction(bone.from), bone.blend);
  return from.slerp(bone.blend, to);
}

/// Returns the heading, which without_yaw() removes.
Eigen::Quaternionf heading(const Eigen::Quaternionf& rotation) {
  return (rotation * without_yaw(rotation).conjugate()).normalized();
}

/// Returns the turn of each rig bone from the body's own rest pose.
std::vector<Eigen::Quaternionf> rig_rotations(const std::vector<RigBone>& rig, const Pose& pose) {
  const auto world = world_rotations(pose);
  std::vector<Eigen::Quaternionf> curls(rig.size());
  std::vector<Eigen::Quaternionf> rotations(rig.size());
  for (std::size_t b = 0; b < rig.size(); ++b) {
    const RigBone& bone = rig[b];
    curls[b] = bone.parent < 0 ? Eigen::Quaternionf::Identity() : curls[bone.parent];
    if (bone.grip != Grip::none) {
      const float grip = bone.grip == Grip::left ? pose.l_grip : pose.r_grip;
      curls[b] = curls[b] * Eigen::Quaternionf(Eigen::AngleAxisf(grip * bone.curl_rad, bone.curl_axis));
    }
    rotations[b] = bone.hangs ? heading(world[index(bone.from)])
                              : (blended(bone, world) * bone.t_from_rest * curls[b]).normalized();
  }
  return rotations;
}

std::vector<Placement> rig_placements(const std::vector<RigBone>& rig, const Pose& pose) {
  const std::vector<Eigen::Quaternionf> rotations = rig_rotations(rig, pose);
  std::vector<Placement> placements(rig.size());
  for (std::size_t b = 0; b < rig.size(); ++b) {
    const Eigen::Vector3f head = rig[b].parent < 0 ? rig[b].head : moved(placements[rig[b].parent], rig[b].head);
    placements[b] = placement(rotations[b], rig[b].head, head);
  }
  return placements;
}

void place_bones(const BodyMesh& mesh, const std::vector<Placement>& placements, PosedBody& out) {
  const auto rig_of = [&](int bone) { return mesh.rig_of[bone]; };
  for (int b = 0; b < kBoneCount; ++b) out.joints[b] = moved(placements[rig_of(b)], mesh.rig[rig_of(b)].head);
  for (int b = 0; b < kBoneCount; ++b) {
    const int after = index(next_bone(static_cast<Bone>(b)));
    out.ends[b] = after == b ? moved(placements[rig_of(b)], mesh.rig[rig_of(b)].tail) : out.joints[after];
  }
}

std::vector<Eigen::Vector3f> part_centres(const std::vector<PartShare>& shares,
                                          const std::vector<Placement>& placements, int part_count) {
  std::vector<bool> found(part_count, false);
  std::vector<Eigen::Vector3f> centres(part_count, Eigen::Vector3f::Zero());
  for (const PartShare& s : shares) {
    centres[s.part] += moved(placements[s.bone], s.moment, s.share);
    found[s.part] = true;
  }
  for (std::size_t p = 0; p < found.size(); ++p) {
    if (!found[p]) centres[p].setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  return centres;
}

void expect_finite(const Pose& pose) {
  bool good = std::isfinite(pose.l_grip) && std::isfinite(pose.r_grip);
  for (const Eigen::Quaternionf& q : pose.local) good = good && std::abs(q.squaredNorm() - 1.F) < 1e-2F;
  if (!good) throw Error("pose: expected rotations by unit quaternions and finite grips");
}

constexpr std::array kFreeEnds = {Bone::head, Bone::l_hand, Bone::r_hand, Bone::l_foot, Bone::r_foot};

}  // namespace

std::vector<PartShare> part_shares(const BodyMesh& mesh, int part_count) {
  std::vector<std::vector<std::uint32_t>> triangles(part_count);
  for (std::size_t t = 0; t < mesh.topology->body_triangles; ++t) {
    const std::uint8_t part = mesh.topology->part[t];
    if (part < triangles.size()) triangles[part].push_back(static_cast<std::uint32_t>(t));
  }
  std::vector<PartShare> shares;
  for (int part = 0; part < part_count; ++part) {
    const auto& own = triangles[part];
    if (!own.empty()) add_part(mesh, part, own, shares);
  }
  return shares;
}

Poser::Poser(std::shared_ptr<const BodyMesh> mesh, const BodyModel& body)
    : mesh_(std::move(mesh)), part_count_(body.part_count()) {
  check(*mesh_, body);
  shares_ = part_shares(*mesh_, part_count_);
  grounded_.assign(mesh_->vertices.size(), 0);
  for (std::size_t t = 0; t < mesh_->topology->triangles.size(); ++t) {
    if (mesh_->topology->part[t] == kBackground) continue;
    for (const std::uint32_t v : mesh_->topology->triangles[t]) grounded_[v] = 1;
  }
}

PosedBody Poser::pose(const Pose& pose) const {
  expect_finite(pose);
  const std::vector<Placement> placements = rig_placements(mesh_->rig, pose);
  PosedBody out;
  out.vertices.resize(mesh_->vertices.size());
  float lowest = std::numeric_limits<float>::max();
  for (std::size_t v = 0; v < out.vertices.size(); ++v) {
    const SkinWeights& skin = mesh_->topology->skin[v];
    Placement blended{};
    for (std::size_t k = 0; k < 4 && skin.weight[k] > 0.F; ++k) {
      const Placement& m = placements[skin.bone[k]];
      for (std::size_t i = 0; i < 12; ++i) blended[i] += skin.weight[k] * m[i];
    }
    out.vertices[v] = moved(blended, mesh_->vertices[v]);
    if (grounded_[v] != 0) lowest = std::min(lowest, out.vertices[v].y());
  }
  place_bones(*mesh_, placements, out);
  out.parts = part_centres(shares_, placements, part_count_);
  const Eigen::Vector3f& pelvis = out.joints[0];
  const Eigen::Vector3f shift(-pelvis.x(), -lowest, -pelvis.z());
  for (Eigen::Vector3f& p : out.vertices) p += shift;
  for (Eigen::Vector3f& p : out.parts) p += shift;
  for (Eigen::Vector3f& p : out.ends) p += shift;
  for (Eigen::Vector3f& p : out.joints) p += shift;
  return out;
}

const std::vector<std::string>& joint_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    all.reserve(kBoneCount + kFreeEnds.size());
    for (int b = 0; b < kBoneCount; ++b) all.emplace_back(bone_name(static_cast<Bone>(b)));
    for (const Bone bone : kFreeEnds) all.push_back(std::string(bone_name(bone)) + "_end");
    return all;
  }();
  return names;
}

std::vector<Eigen::Vector3f> joint_points(const PosedBody& body, const Eigen::Isometry3f& camera_from_body) {
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3f& p : body.joints) points.emplace_back(camera_from_body * p);
  for (const Bone bone : kFreeEnds) points.emplace_back(camera_from_body * body.ends[index(bone)]);
  return points;
}

}  // namespace vesalius::synth
