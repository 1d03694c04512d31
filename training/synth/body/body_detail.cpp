#include "synth/body/body_detail.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "synth/pose/joint_angles.h"

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
  std::vector<std::vector<std::uint32_t>> made_of(points.size());  // for each vertex of the topology
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    const auto alike = [&](std::uint32_t made) {
      const std::uint32_t other = surface.look_of[made];
      return topology.part[other] == topology.part[t] && topology.fabric[other] == topology.fabric[t];
    };
    for (const std::uint32_t v : topology.triangles[t]) {
      auto found = std::ranges::find_if(made_of[v], alike);
      if (found == made_of[v].end()) {
        found = made_of[v].insert(found, static_cast<std::uint32_t>(surface.points.size()));
        surface.original.push_back(v);
        surface.look_of.push_back(t);
        surface.points.push_back(points[v]);
      }
      surface.corners.push_back(*found);
    }
  }
  return surface;
}

std::uint32_t next_corner(std::uint32_t c) { return c % 3 == 2 ? c - 2 : c + 1; }

/// The corners of triangles by the vertex at which they are.
class CornersAt {
 public:
  CornersAt(const std::vector<std::uint32_t>& corners, std::size_t vertices)
      : corners_(corners), first_(vertices + 1, 0), sorted_(corners.size()) {
    for (const std::uint32_t v : corners) ++first_[v];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    for (std::size_t c = corners.size(); c-- > 0;) sorted_[--first_[corners[c]]] = static_cast<std::uint32_t>(c);
  }
  /// Returns the triangle with the edge from a to b, or kNone.
  std::uint32_t triangle(std::uint32_t a, std::uint32_t b) const {
    for (std::uint32_t i = first_[a]; i < first_[a + 1]; ++i) {
      if (corners_[next_corner(sorted_[i])] == b) return sorted_[i] / 3;
    }
    return kNone;
  }

 private:
  const std::vector<std::uint32_t>& corners_;
  std::vector<std::uint32_t> first_, sorted_;
};

/// Returns triangles of those corners in an order in which neighbours across a long edge follow each other, since
/// SceneGeometry joins them to quads. Triangles without a partner are last.
std::vector<Triangle> paired(const std::vector<std::uint32_t>& corners, const std::vector<Eigen::Vector3f>& points) {
  const CornersAt at(corners, points.size());
  const auto corners_of = [&](std::uint32_t t) {
    return Triangle{corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]};
  };
  std::vector<Triangle> order, alone;
  std::vector<std::uint8_t> taken(corners.size() / 3, 0);
  for (std::uint32_t t = 0; t < taken.size(); ++t) {
    if (taken[t] != 0) continue;
    taken[t] = 1;
    std::uint32_t partner = kNone;
    float longest = 0.F;
    for (std::uint32_t c = 3 * t; c < 3 * t + 3; ++c) {
      const std::uint32_t a = corners[c], b = corners[next_corner(c)];
      const float length = (points[a] - points[b]).squaredNorm();
      if (length <= longest) continue;
      const std::uint32_t other = at.triangle(b, a);
      if (other == kNone || taken[other] != 0) continue;
      partner = other;
      longest = length;
    }
    (partner == kNone ? alone : order).push_back(corners_of(t));
    if (partner == kNone) continue;
    taken[partner] = 1;
    order.push_back(corners_of(partner));
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

/// Returns a pose with every joint half bent, so that surfaces that bend are not flat in it.
Pose half_bent() {
  BodyAngles angles;
  angles.trunk = {30.F, 10.F, 15.F};
  angles.neck = {20.F, 10.F, 20.F};
  for (ArmAngles& arm : angles.arms) {
    arm.elevation = 50.F;
    arm.plane = 45.F;
    arm.elbow = 60.F;
    arm.pronation = 30.F;
    arm.wrist = 25.F;
  }
  for (LegAngles& leg : angles.legs) {
    leg.flexion = 50.F;
    leg.abduction = 15.F;
    leg.external = 15.F;
    leg.knee = 60.F;
    leg.ankle = 10.F;
  }
  angles.grip = {0.5F, 0.5F};
  return pose_of(angles);
}

}  // namespace

std::vector<CoarseSurface> simplify(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points,
                                    const std::vector<float>& errors_m) {
  const SeamedSurface surface = with_seams(topology, points);
  const float* places = surface.points.data()->data();
  const std::size_t count = surface.points.size();
  const float scale_m = meshopt_simplifyScale(places, count, sizeof(Eigen::Vector3f));
  std::vector<CoarseSurface> levels;
  std::vector<std::uint32_t> corners = surface.corners;
  float before_m = 0.F;  // errors of one level after the other add up by their squares
  for (const float error_m : errors_m) {
    const float further_m = std::sqrt(std::max(0.F, error_m * error_m - before_m * before_m));
    const std::vector<std::uint32_t> from = corners;
    corners.resize(meshopt_simplify(corners.data(), from.data(), from.size(), places, count, sizeof(Eigen::Vector3f), 0,
                                    further_m / scale_m, 0, nullptr));
    levels.push_back(coarse_surface(topology, surface, corners, error_m));
    before_m = error_m;
  }
  return levels;
}

BodyDetail::BodyDetail(const Poser& poser) {
  levels_ = simplify(*poser.mesh().topology, poser.pose(half_bent()).vertices,
                     {0.0005F, 0.0008F, 0.0013F, 0.002F, 0.0032F, 0.005F});
}

const CoarseSurface* BodyDetail::within(float error_m) const {
  const CoarseSurface* coarsest = nullptr;
  for (const CoarseSurface& level : levels_) {
    if (level.error_m <= error_m) coarsest = &level;
  }
  return coarsest;
}

}  // namespace vesalius::synth
