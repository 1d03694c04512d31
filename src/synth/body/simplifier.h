#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "synth/body/simplify.h"

namespace vesalius::synth {

/// Mean of squared distances to planes, each with a weight.
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

/// What may happen to a vertex: anything, a move along the one border it lies on, or nothing.
enum class Kind : std::uint8_t { free, border, fixed };

/// What simplify() works with: a surface that loses vertices.
class Simplifier {
 public:
  /// Keeps a reference to `topology`.
  Simplifier(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points);
  /// Moves vertices while any can go for that root mean square error.
  void run_to(double error_m);
  /// What is left.
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
  std::vector<std::uint8_t> alive_;                 ///< per triangle
  std::vector<std::uint32_t> first_, last_, next_;  ///< per vertex, per vertex, per corner: corners at a vertex
  std::vector<Kind> kind_;
  std::vector<Quadric> quadrics_;
  std::vector<double> waits_for_;  ///< per vertex: no target costs less; kNever: none until the neighbours change
  std::vector<std::uint32_t> seen_, candidates_;  ///< scratch
  std::uint32_t epoch_ = 0;
};

}  // namespace vesalius::synth
