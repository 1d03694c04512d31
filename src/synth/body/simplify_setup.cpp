#include <algorithm>

#include "synth/body/simplifier.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3d;

constexpr double kSmallestArea = 1e-12;  // keeps weights above 0 where a triangle has no area

}  // namespace

Simplifier::Simplifier(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points)
    : topology_(topology),
      triangles_(topology.triangles),
      alive_(triangles_.size(), 1),
      first_(points.size(), kNone),
      last_(points.size(), kNone),
      next_(3 * triangles_.size(), kNone),
      kind_(points.size(), Kind::free),
      quadrics_(points.size()),
      waits_for_(points.size(), 0.0),
      seen_(points.size(), 0) {
  points_.reserve(points.size());
  for (const Eigen::Vector3f& p : points) points_.push_back(p.cast<double>());
  link_corners();
  add_planes();
  find_borders();
}

void Simplifier::link_corners() {
  std::ranges::fill(first_, kNone);
  for (std::uint32_t c = 0; c < next_.size(); ++c) {
    if (alive_[c / 3] == 0) continue;
    const std::uint32_t v = triangles_[c / 3][c % 3];
    (first_[v] == kNone ? first_[v] : next_[last_[v]]) = c;
    last_[v] = c;
    next_[c] = kNone;
  }
}

void Simplifier::add_planes() {
  for (const Triangle& t : triangles_) {
    const Vector3d& a = points_[t[0]];
    const Vector3d across = (points_[t[1]] - a).cross(points_[t[2]] - a);
    const double area = across.norm() + kSmallestArea;
    const Vector3d normal = across / area;
    for (const std::uint32_t v : t) quadrics_[v].add_plane(normal, -normal.dot(a), area);
  }
}

/// Classifies vertices; and planes along borders, upright on their triangles, make leaving a border cost as much as
/// leaving the surface.
void Simplifier::find_borders() {
  constexpr int kManyTriangles = 5;
  std::vector<int> sides(points_.size(), 0);  // of borders' edges at a vertex: two an edge
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
      int others = 0;
      bool alike = true;
      each_triangle(a, [&](std::uint32_t other) {
        if (other == t || !has(other, b)) return;
        ++others;
        alike = alike && same_look(t, other);
      });
      if (others == 1 && alike) continue;
      const int here = others == 0 ? 2 : others == 1 ? 1 : kManyTriangles;
      for (const std::uint32_t v : {a, b}) sides[v] += here;
      add_border(t, a, b);
    }
  }
  for (std::size_t v = 0; v < sides.size(); ++v) {
    if (sides[v] > 0) kind_[v] = sides[v] == 4 ? Kind::border : Kind::fixed;
  }
}

void Simplifier::add_border(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) {
  const Triangle& t = triangles_[triangle];
  const Vector3d along = points_[b] - points_[a];
  const Vector3d up = (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]);
  const Vector3d normal = along.cross(up).stableNormalized();
  for (const std::uint32_t v : {a, b}) {
    quadrics_[v].add_plane(normal, -normal.dot(points_[a]), along.squaredNorm() + kSmallestArea);
  }
}

/// Whether an edge is anything but inside one part and fabric.
bool Simplifier::is_border(std::uint32_t a, std::uint32_t b) const {
  std::array<std::uint32_t, 2> beside{};
  std::size_t count = 0;
  each_triangle(a, [&](std::uint32_t t) {
    if (!has(t, b)) return;
    if (count < 2) beside[count] = t;
    ++count;
  });
  return count != 2 || !same_look(beside[0], beside[1]);
}

CoarseSurface Simplifier::result(float error_m) const {
  CoarseSurface out;
  out.error_m = error_m;
  const std::vector<std::uint32_t> order = paired();
  std::vector<std::uint32_t> place(points_.size(), kNone);
  for (const std::uint32_t t : order) {
    for (const std::uint32_t v : triangles_[t]) place[v] = 0;
  }
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    if (place[v] == kNone) continue;
    place[v] = static_cast<std::uint32_t>(out.vertex.size());
    out.vertex.push_back(v);
  }
  for (const std::uint32_t t : order) {
    const Triangle& corners = triangles_[t];
    out.triangles.push_back({place[corners[0]], place[corners[1]], place[corners[2]]});
    out.part.push_back(topology_.part[t]);
    out.fabric.push_back(static_cast<std::uint8_t>(topology_.fabric[t]));
  }
  return out;
}

/// The triangles that are left, neighbours across a long edge one after the other, as SceneGeometry joins them to
/// quads; those that stay alone last.
std::vector<std::uint32_t> Simplifier::paired() const {
  std::vector<std::uint32_t> order, alone;
  std::vector<std::uint8_t> taken(triangles_.size(), 0);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    if (alive_[t] == 0 || taken[t] != 0) continue;
    taken[t] = 1;
    std::uint32_t partner = kNone;
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
      const double length = (points_[a] - points_[b]).squaredNorm();
      if (length <= longest) continue;
      each_triangle(a, [&](std::uint32_t other) {
        if (taken[other] != 0 || !has(other, b)) return;
        partner = other;
        longest = length;
      });
    }
    if (partner == kNone) {
      alone.push_back(t);
      continue;
    }
    taken[partner] = 1;
    order.insert(order.end(), {t, partner});
  }
  order.insert(order.end(), alone.begin(), alone.end());
  return order;
}

}  // namespace vesalius::synth
