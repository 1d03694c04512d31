#include "synth/body/part_shares.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <span>

namespace vesalius::synth {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Skin = std::vector<std::pair<std::uint16_t, float>>;

/// The zeroth and first moment of the volume that each bone carries.
class Moments {
 public:
  explicit Moments(std::size_t bones) : volume_(bones, 0.0), first_(bones, Eigen::Vector3d::Zero()) {}

  /// Adds the tetrahedron between a triangle and the origin.
  void add(const std::array<Eigen::Vector3d, 3>& p, const Skin& skin) {
    const double volume = p[0].dot(p[1].cross(p[2])) / 6.0;
    const Eigen::Vector3d centre = (p[0] + p[1] + p[2]) / 4.0;
    for (const auto& [bone, weight] : skin) {
      volume_[bone] += volume * weight;
      first_[bone] += volume * weight * centre;
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
  std::vector<double> volume_;
  std::vector<Eigen::Vector3d> first_;
};

/// Returns the mean weights of some vertices.
Skin mean_skin(const BodyMesh& mesh, std::span<const std::uint32_t> vertices) {
  Skin skin;
  const float scale = 1.F / float(vertices.size());
  for (const std::uint32_t v : vertices) {
    const SkinWeights& weights = mesh.topology->skin[v];
    for (std::size_t k = 0; k < 4; ++k) {
      if (weights.weight[k] > 0.F) skin.emplace_back(weights.bone[k], weights.weight[k] * scale);
    }
  }
  return skin;
}

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
  Moments moments(mesh.rig.size());
  for (const std::uint32_t t : triangles) {
    const Triangle& tri = mesh.topology->triangles[t];
    moments.add({point(tri[0]) - origin, point(tri[1]) - origin, point(tri[2]) - origin}, mean_skin(mesh, tri));
  }
  const std::vector<Edge> open = open_edges(mesh, triangles);
  Rims rims(mesh, open);
  for (const auto& [a, b] : open) {
    moments.add({point(a) - origin, point(b) - origin, rims.middle(a) - origin},
                mean_skin(mesh, std::array<std::uint32_t, 2>{a, b}));
  }
  moments.write(part, origin, out);
}

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

}  // namespace vesalius::synth
