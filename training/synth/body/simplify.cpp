#include "synth/body/simplify.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace vesalius::synth {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// A surface with a vertex for each look (part and fabric) at each of its points. Vertices at the same place are a seam
/// to meshoptimizer, so borders between looks keep their course, and the look of a triangle is that of its corners.
struct SeamedSurface {
  std::vector<std::uint32_t> original;  ///< for each vertex that of the topology
  std::vector<std::uint32_t> look_of;   ///< for each vertex a triangle of the topology with its look
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> corners;  ///< three for each triangle
};

SeamedSurface with_seams(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points) {
  SeamedSurface surface;
  std::map<std::pair<std::uint32_t, int>, std::uint32_t> known;
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    const int look = topology.part[t] * kFabricCount + static_cast<int>(topology.fabric[t]);
    for (const std::uint32_t v : topology.triangles[t]) {
      const auto [at, is_new] = known.emplace(std::pair(v, look), static_cast<std::uint32_t>(surface.points.size()));
      if (is_new) {
        surface.original.push_back(v);
        surface.look_of.push_back(t);
        surface.points.push_back(points[v]);
      }
      surface.corners.push_back(at->second);
    }
  }
  return surface;
}

/// Returns triangles of those corners in an order in which neighbours across a long edge follow each other, since
/// SceneGeometry joins them to quads. Triangles without a partner are last.
std::vector<Triangle> paired(const std::vector<std::uint32_t>& corners, const std::vector<Eigen::Vector3f>& points) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> triangle_at;  // by directed edge
  std::vector<Triangle> triangles;
  for (std::uint32_t t = 0; 3 * t < corners.size(); ++t) {
    triangles.push_back({corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]});
    for (std::size_t k = 0; k < 3; ++k) triangle_at[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
  }
  std::vector<Triangle> order, alone;
  std::vector<std::uint8_t> taken(triangles.size(), 0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (taken[t] != 0) continue;
    taken[t] = 1;
    std::uint32_t partner = kNone;
    float longest = 0.F;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      const float length = (points[a] - points[b]).squaredNorm();
      const auto other = triangle_at.find({b, a});
      if (length <= longest || other == triangle_at.end() || taken[other->second] != 0) continue;
      partner = other->second;
      longest = length;
    }
    (partner == kNone ? alone : order).push_back(triangles[t]);
    if (partner == kNone) continue;
    taken[partner] = 1;
    order.push_back(triangles[partner]);
  }
  order.insert(order.end(), alone.begin(), alone.end());
  return order;
}

CoarseSurface coarse_surface(const BodyTopology& topology, const SeamedSurface& surface,
                             const std::vector<std::uint32_t>& corners, float error_m) {
  CoarseSurface out;
  out.error_m = error_m;
  std::vector<std::uint32_t> place(1 + *std::ranges::max_element(surface.original), kNone);
  for (const std::uint32_t corner : corners) place[surface.original[corner]] = 0;
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    if (place[v] == kNone) continue;
    place[v] = static_cast<std::uint32_t>(out.vertex.size());
    out.vertex.push_back(v);
  }
  for (const Triangle& t : paired(corners, surface.points)) {
    const auto at = [&](std::uint32_t corner) { return place[surface.original[corner]]; };
    out.triangles.push_back({at(t[0]), at(t[1]), at(t[2])});
    out.part.push_back(topology.part[surface.look_of[t[0]]]);
    out.fabric.push_back(static_cast<std::uint8_t>(topology.fabric[surface.look_of[t[0]]]));
  }
  return out;
}

}  // namespace

std::vector<CoarseSurface> simplify(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points,
                                    const std::vector<float>& errors_m) {
  const SeamedSurface surface = with_seams(topology, points);
  const float* places = surface.points.data()->data();
  const std::size_t count = surface.points.size();
  const float scale_m = meshopt_simplifyScale(places, count, sizeof(Eigen::Vector3f));
  std::vector<CoarseSurface> levels;
  for (const float error_m : errors_m) {
    std::vector<std::uint32_t> corners(surface.corners.size());
    corners.resize(meshopt_simplify(corners.data(), surface.corners.data(), surface.corners.size(), places, count,
                                    sizeof(Eigen::Vector3f), 0, error_m / scale_m, 0, nullptr));
    levels.push_back(coarse_surface(topology, surface, corners, error_m));
  }
  return levels;
}

}  // namespace vesalius::synth
