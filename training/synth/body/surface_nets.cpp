#include "synth/body/surface_nets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace vesalius::synth {
namespace {

/// The sum over limbs at every grid point.
class Field {
 public:
  Field(const HalfGrid& grid, float softness_m) : lines_(grid.lines), softness_m_(softness_m) {
    for (std::size_t a = 0; a < 3; ++a) size_[a] = lines_[a].size();
    values_.assign(size_[0] * size_[1] * size_[2], 0.F);
  }

  void add(const Limb& limb, bool in_mirror) {
    constexpr float kReach = 4.5F;  // a limb at more than this many softnesses adds less than 1 %
    Bounds box = bounds(limb);
    if (in_mirror) box = {{-box.high.x(), box.low.y(), box.low.z()}, {-box.low.x(), box.high.y(), box.high.z()}};
    std::array<std::size_t, 3> first{};
    std::array<std::size_t, 3> last{};
    for (std::size_t a = 0; a < 3; ++a) {
      const float reach = kReach * softness_m_;
      const auto i = static_cast<Eigen::Index>(a);
      first[a] = static_cast<std::size_t>(std::ranges::lower_bound(lines_[a], box.low[i] - reach) - lines_[a].begin());
      last[a] = static_cast<std::size_t>(std::ranges::upper_bound(lines_[a], box.high[i] + reach) - lines_[a].begin());
    }
    first[0] = std::max<std::size_t>(first[0], 1);  // the first column mirrors the second
    const LimbDistance distance(limb);
    for (std::size_t k = first[2]; k < last[2]; ++k) {
      for (std::size_t j = first[1]; j < last[1]; ++j) {
        for (std::size_t i = first[0]; i < last[0]; ++i) {
          const Eigen::Vector3f p(in_mirror ? -lines_[0][i] : lines_[0][i], lines_[1][j], lines_[2][k]);
          const float d = distance.nearest(p, kReach * softness_m_).distance_m / softness_m_;
          if (d < kReach) values_[at(i, j, k)] += std::exp(-std::max(d, -20.F));
        }
      }
    }
  }

  void close() {
    for (std::size_t k = 0; k < size_[2]; ++k) {
      for (std::size_t j = 0; j < size_[1]; ++j) values_[at(0, j, k)] = values_[at(1, j, k)];
    }
  }

  std::size_t at(std::size_t i, std::size_t j, std::size_t k) const { return (k * size_[1] + j) * size_[0] + i; }
  bool inside(std::size_t i, std::size_t j, std::size_t k) const { return values_[at(i, j, k)] > 1.F; }
  /// Returns whether the surface passes through the cell with this lowest corner.
  bool cut(std::size_t corner) const {
    const std::size_t row = size_[0];
    const std::size_t layer = size_[0] * size_[1];
    int inside_count = 0;
    for (const std::size_t c : {corner, corner + row, corner + layer, corner + layer + row}) {
      inside_count += (values_[c] > 1.F ? 1 : 0) + (values_[c + 1] > 1.F ? 1 : 0);
    }
    return inside_count != 0 && inside_count != 8;
  }
  /// Returns the height above the surface in softnesses; it is negative inside.
  float height(std::size_t point) const { return -std::log(std::max(values_[point], 1e-3F)); }
  const std::array<std::size_t, 3>& size() const { return size_; }
  Eigen::Vector3f point(const std::array<std::size_t, 3>& i) const {
    return {lines_[0][i[0]], lines_[1][i[1]], lines_[2][i[2]]};
  }

 private:
  const std::array<std::vector<float>, 3>& lines_;
  float softness_m_;
  std::array<std::size_t, 3> size_{};
  std::vector<float> values_;
};

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// The vertices of the half with x >= 0, one in every cell that the surface cuts.
class Nets {
 public:
  explicit Nets(const Field& field)
      : field_(field), vertex_of_(field.size()[0] * field.size()[1] * field.size()[2], kNone) {}

  Surface half() {
    const auto& n = field_.size();
    for (std::size_t k = 0; k + 1 < n[2]; ++k) {
      for (std::size_t j = 0; j + 1 < n[1]; ++j) {
        for (std::size_t i = 0; i + 1 < n[0]; ++i) {
          if (field_.cut(field_.at(i, j, k))) add_vertex({i, j, k});
        }
      }
    }
    for (std::size_t k = 1; k + 1 < n[2]; ++k) {
      for (std::size_t j = 1; j + 1 < n[1]; ++j) {
        for (std::size_t i = 1; i + 1 < n[0]; ++i) add_faces({i, j, k});
      }
    }
    return std::move(surface_);
  }

 private:
  using Cell = std::array<std::size_t, 3>;

  /// Adds the mean of the points where the surface cuts the cell's edges.
  void add_vertex(const Cell& cell) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int cuts = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t side = 0; side < 4; ++side) {
        Cell from = cell;
        from[(axis + 1) % 3] += side & 1U;
        from[(axis + 2) % 3] += side >> 1U;
        Cell to = from;
        ++to[axis];
        if (inside(from) == inside(to)) continue;
        const float a = field_.height(field_.at(from[0], from[1], from[2]));
        const float b = field_.height(field_.at(to[0], to[1], to[2]));
        sum += field_.point(from) + a / (a - b) * (field_.point(to) - field_.point(from));
        ++cuts;
      }
    }
    vertex_of_[field_.at(cell[0], cell[1], cell[2])] = static_cast<std::uint32_t>(surface_.vertices.size());
    surface_.vertices.push_back(sum / static_cast<float>(cuts));
    if (cell[0] == 0) surface_.vertices.back().x() = 0.F;
  }

  /// Adds a quadrilateral between the four cells around each edge from this point that the surface cuts.
  void add_faces(const Cell& point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Cell to = point;
      ++to[axis];
      const bool from_inside = inside(point);
      if (from_inside == inside(to)) continue;
      std::array<std::uint32_t, 4> quad{};
      constexpr std::array<std::array<std::size_t, 2>, 4> kAround{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
      for (std::size_t corner = 0; corner < 4; ++corner) {
        Cell cell = point;
        cell[(axis + 1) % 3] -= kAround[corner][0];
        cell[(axis + 2) % 3] -= kAround[corner][1];
        quad[corner] = vertex_of_[field_.at(cell[0], cell[1], cell[2])];
      }
      if (!from_inside) std::swap(quad[1], quad[3]);
      surface_.triangles.push_back({quad[0], quad[1], quad[2]});
      surface_.triangles.push_back({quad[0], quad[2], quad[3]});
    }
  }

  bool inside(const Cell& c) const { return field_.inside(c[0], c[1], c[2]); }

  const Field& field_;
  std::vector<std::uint32_t> vertex_of_;
  Surface surface_;
};

void add_mirror_image(Surface& surface) {
  std::vector<std::uint32_t> twin;
  const std::size_t vertices = surface.vertices.size();
  for (std::size_t v = 0; v < vertices; ++v) {
    const Eigen::Vector3f p = surface.vertices[v];
    const bool middle = p.x() == 0.F;
    twin.push_back(static_cast<std::uint32_t>(middle ? v : surface.vertices.size()));
    if (!middle) surface.vertices.emplace_back(-p.x(), p.y(), p.z());
  }
  const std::size_t triangles = surface.triangles.size();
  for (std::size_t t = 0; t < triangles; ++t) {
    const Triangle tri = surface.triangles[t];
    surface.triangles.push_back({twin[tri[2]], twin[tri[1]], twin[tri[0]]});
  }
}

}  // namespace

Surface melt(const std::vector<Limb>& limbs, float softness_m, const HalfGrid& grid) {
  Field field(grid, softness_m);
  for (const Limb& limb : limbs) {
    field.add(limb, false);
    if (limb.paired) field.add(limb, true);
  }
  field.close();
  Surface surface = Nets(field).half();
  add_mirror_image(surface);
  return surface;
}

}  // namespace vesalius::synth
