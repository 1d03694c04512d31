#include "synth/body/simplify.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace vesalius::synth {
namespace {

using Eigen::Vector3d;

constexpr double kLongestEdge_m = 0.06;      // longer edges would be visible in poses other than the measured one
constexpr double kSmallestTurnCosine = 0.3;  // largest turn of a remaining triangle
constexpr double kSmallestArea = 1e-12;      // keeps weights above 0 if a triangle has no area

/// The weighted mean of squared distances to planes.
class Quadric {
 public:
  void add_plane(const Eigen::Vector3d& n, double d, double weight) {
    const std::array<double, 4> p{n.x(), n.y(), n.z(), d};
    std::size_t at = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i; j < 4; ++j) m_[at++] += weight * p[i] * p[j];
    }
    weight_ += weight;
  }
  void add(const Quadric& other) {
    for (std::size_t i = 0; i < m_.size(); ++i) m_[i] += other.m_[i];
    weight_ += other.weight_;
  }
  double at(const Eigen::Vector3d& p) const {
    const double sum = p.x() * (m_[0] * p.x() + 2 * (m_[1] * p.y() + m_[2] * p.z() + m_[3])) +
                       p.y() * (m_[4] * p.y() + 2 * (m_[5] * p.z() + m_[6])) + p.z() * (m_[7] * p.z() + 2 * m_[8]) +
                       m_[9];
    return sum / weight_;
  }

 private:
  std::array<double, 10> m_{};
  double weight_ = 0.0;
};

/// The allowed moves of a vertex: any, along the one border on which it lies, or none.
enum class Kind : std::uint8_t { free, border, fixed };

/// A surface that loses vertices.
class Simplifier {
 public:
  /// Keeps a reference to `topology`.
  Simplifier(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points);
  /// Moves vertices as long as any can move within that root mean square error.
  void run_to(double error_m);
  /// Returns the remaining surface.
  CoarseSurface result(float error_m) const;

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  template <class F>
  void each_triangle(std::uint32_t vertex, F&& visit) const {
    for (std::uint32_t c = first_[vertex]; c != kNone; c = next_[c]) {
      if (alive_[c / 3] != 0) visit(c / 3);
    }
  }
  template <class F>
  void each_neighbour(std::uint32_t vertex, F&& visit) {
    ++epoch_;
    each_triangle(vertex, [&](std::uint32_t t) {
      for (const std::uint32_t n : triangles_[t]) {
        if (n == vertex || seen_[n] == epoch_) continue;
        seen_[n] = epoch_;
        visit(n);
      }
    });
  }
  bool has(std::uint32_t triangle, std::uint32_t v) const {
    const Triangle& t = triangles_[triangle];
    return t[0] == v || t[1] == v || t[2] == v;
  }
  bool same_look(std::uint32_t a, std::uint32_t b) const {
    return topology_.part[a] == topology_.part[b] && topology_.fabric[a] == topology_.fabric[b];
  }

  void link_corners();
  void add_planes();
  void find_borders();
  void add_border(std::uint32_t triangle, std::uint32_t a, std::uint32_t b);
  bool is_border(std::uint32_t a, std::uint32_t b) const;
  double cost(std::uint32_t from, std::uint32_t to) const;
  bool sweep(double most);
  std::uint32_t best_target(std::uint32_t from, double most);
  bool keeps_shape(std::uint32_t from, std::uint32_t to);
  bool turns_over(std::uint32_t triangle, std::uint32_t from, std::uint32_t to) const;
  void collapse(std::uint32_t from, std::uint32_t to);
  std::vector<std::uint32_t> paired() const;

  const BodyTopology& topology_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint8_t> alive_;  ///< per triangle
  std::vector<std::uint32_t> first_, last_,
      next_;  ///< lists of the corners at each vertex: first and last by vertex, next by corner
  std::vector<Kind> kind_;
  std::vector<Quadric> quadrics_;
  std::vector<double> waits_for_;  ///< for each vertex the lowest cost of any target; kNever if there is none for now
  std::vector<std::uint32_t> seen_, candidates_;  ///< temporary memory
  std::uint32_t epoch_ = 0;
};

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

/// Classifies vertices. Planes along borders, perpendicular to their triangles, make leaving a border cost as much as
/// leaving the surface.
void Simplifier::find_borders() {
  constexpr int kManyTriangles = 5;
  std::vector<int> sides(points_.size(), 0);  // number of sides of border edges at a vertex, two for each edge
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

/// Returns whether an edge is not inside one part and fabric.
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

/// Returns the remaining triangles in an order in which neighbours across a long edge follow each other, since
/// SceneGeometry joins them to quads. Triangles without a partner are last.
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

/// Returns the mean squared error of moving a vertex onto its neighbour.
double Simplifier::cost(std::uint32_t from, std::uint32_t to) const {
  if (kind_[from] == Kind::border && (kind_[to] == Kind::free || !is_border(from, to))) return kNever;
  if ((points_[from] - points_[to]).squaredNorm() > kLongestEdge_m * kLongestEdge_m) return kNever;
  return std::max(0.0, quadrics_[from].at(points_[to]));
}

bool Simplifier::turns_over(std::uint32_t triangle, std::uint32_t from, std::uint32_t to) const {
  const Triangle& t = triangles_[triangle];
  const std::size_t k = t[0] == from ? 0 : t[1] == from ? 1 : 2;
  const Vector3d& b = points_[t[(k + 1) % 3]];
  const Vector3d side = points_[t[(k + 2) % 3]] - b;
  const Vector3d before = side.cross(points_[from] - b);
  const Vector3d after = side.cross(points_[to] - b);
  const double along = before.dot(after);
  return !(along > 0.0 &&
           along * along > kSmallestTurnCosine * kSmallestTurnCosine * before.squaredNorm() * after.squaredNorm());
}

/// Returns whether the surface stays simple and without folds. Both ends may share only the neighbours that their
/// common triangles have.
bool Simplifier::keeps_shape(std::uint32_t from, std::uint32_t to) {
  std::ptrdiff_t shared_triangles = 0, triangles = 0;
  bool turned = false;
  each_triangle(from, [&](std::uint32_t t) {
    ++triangles;
    if (has(t, to)) {
      ++shared_triangles;
    } else {
      turned = turned || turns_over(t, from, to);
    }
  });
  if (turned || shared_triangles == 0 || triangles == shared_triangles) return false;
  candidates_.clear();
  each_neighbour(from, [&](std::uint32_t n) { candidates_.push_back(n); });
  each_neighbour(to, [](std::uint32_t) {});
  return std::ranges::count_if(candidates_, [&](std::uint32_t n) { return seen_[n] == epoch_; }) == shared_triangles;
}

/// Returns the neighbour onto which a vertex moves, or kNone. In the latter case it stores when to look again.
std::uint32_t Simplifier::best_target(std::uint32_t from, double most) {
  std::array<std::pair<double, std::uint32_t>, 12> targets;
  std::size_t count = 0;
  double later = kNever;
  each_neighbour(from, [&](std::uint32_t n) {
    const double c = cost(from, n);
    if (c > most) {
      later = std::min(later, c);
    } else if (count < targets.size()) {
      targets[count++] = {c, n};
    }
  });
  std::sort(targets.begin(), targets.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    if (keeps_shape(from, targets[i].second)) return targets[i].second;
  }
  waits_for_[from] = later;
  return kNone;
}

void Simplifier::collapse(std::uint32_t from, std::uint32_t to) {
  each_triangle(from, [&](std::uint32_t t) {
    if (has(t, to)) {
      alive_[t] = 0;
    } else {
      std::ranges::replace(triangles_[t], from, to);
    }
  });
  next_[last_[to]] = first_[from];
  last_[to] = last_[from];
  first_[from] = last_[from] = kNone;
  quadrics_[to].add(quadrics_[from]);
  waits_for_[from] = kNever;
  waits_for_[to] = 0.0;
  each_neighbour(to, [&](std::uint32_t n) { waits_for_[n] = 0.0; });
}

/// Moves every vertex that can move at that cost. Returns whether any could.
bool Simplifier::sweep(double most) {
  bool moved = false;
  for (std::uint32_t v = 0; v < points_.size(); ++v) {
    if (waits_for_[v] > most || kind_[v] == Kind::fixed || first_[v] == kNone) continue;
    const std::uint32_t to = best_target(v, most);
    if (to == kNone) continue;
    collapse(v, to);
    moved = true;
  }
  return moved;
}

void Simplifier::run_to(double error_m) {
  while (sweep(error_m * error_m)) link_corners();  // drops removed triangles, which keeps the lists short
}

}  // namespace

std::vector<CoarseSurface> simplify(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points,
                                    const std::vector<float>& errors_m) {
  Simplifier simplifier(topology, points);
  std::vector<CoarseSurface> levels;
  for (const float error_m : errors_m) {
    simplifier.run_to(error_m);
    levels.push_back(simplifier.result(error_m));
  }
  return levels;
}

}  // namespace vesalius::synth
