#include "synth/body/simplify.h"

#include <algorithm>

#include "synth/body/simplifier.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3d;

constexpr double kLongestEdge_m = 0.06;      // beyond, the poses other than the measured one would show
constexpr double kSmallestTurnCosine = 0.3;  // of a triangle that stays

}  // namespace

/// Mean squared error of moving a vertex onto its neighbour.
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

/// Whether the surface stays one without folds: the ends share only the neighbours that their triangles do.
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

/// The neighbour that a vertex moves to; kNone where there is none, and when to look again is noted.
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

/// Moves every vertex that can go for that cost; whether any could.
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
  while (sweep(error_m * error_m)) link_corners();  // without the triangles that are gone: lists stay short
}

std::vector<CoarseSurface> simplify(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points,
                                    const std::vector<float>& errors_m) {
  Simplifier simplifier(topology, points);
  std::vector<CoarseSurface> levels;
  for (const float error_m : errors_m) {
    simplifier.run_to(static_cast<double>(error_m));
    levels.push_back(simplifier.result(error_m));
  }
  return levels;
}

}  // namespace vesalius::synth
