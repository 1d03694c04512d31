#include "synth/furniture/soft_support.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "synth/mesh/palette.h"
#include "synth/mesh/shapes.h"

namespace vesalius::synth {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Vector3f;

/// Heights over a level grid of cells.
class Cloth {
 public:
  Cloth(const BlanketPlace& place, float hem_m) : place_(place) {
    const Eigen::Vector2f size = place.high - place.low;
    columns_ = std::max(2, int(size.x() / kCell_m) + 1);
    rows_ = std::max(2, int(size.y() / kCell_m) + 1);
    for (int j = 0; j < rows_; ++j) {
      const float ground = z_of(j) < place.edge_z ? place.ground_m : hem_m;
      height_.insert(height_.end(), static_cast<std::size_t>(columns_), ground);
    }
  }

  void cover(const Vector3f& p) {
    constexpr float kAbove_m = 0.01F;
    const auto i = int(std::lround((p.x() - place_.low.x()) / kCell_m));
    const auto j = int(std::lround((p.z() - place_.low.y()) / kCell_m));
    if (i < 0 || j < 0 || i >= columns_ || j >= rows_ || p.y() > place_.top_m) return;
    at(i, j) = std::max(at(i, j), p.y() + kAbove_m);
  }

  /// Raises each cell to the highest around it: the points are sparse, and cloth spans what lies between.
  void span() {
    const std::vector<float> before = height_;
    for_each([&](int i, int j) {
      float highest = 0.F;
      around(i, j, [&](int a, int b) { highest = std::max(highest, before[index(a, b)]); });
      at(i, j) = highest;
    });
  }

  /// Smooths without going below what is covered.
  void smooth() {
    const std::vector<float> before = height_;
    for_each([&](int i, int j) {
      float sum = 0.F, count = 0.F;
      around(i, j, [&](int a, int b) {
        sum += before[index(a, b)];
        count += 1.F;
      });
      at(i, j) = std::max(before[index(i, j)], sum / count);
    });
  }

  void wrinkle(Random& random) {
    for (int wave = 0; wave < 3; ++wave) {
      const float along = between(8.0, 35.0, random), across = between(-25.0, 25.0, random);
      const float phase = between(0.0, 6.28, random), depth = between(0.0, 0.008, random);
      for_each([&](int i, int j) { at(i, j) += depth * (1.F + std::sin(along * x_of(i) + across * z_of(j) + phase)); });
    }
  }

  SceneMesh mesh(Random& random) const {
    SceneMesh mesh;
    const std::uint8_t cloth = add_material(mesh, sample_material(Stuff::cloth, random));
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) mesh.vertices.emplace_back(x_of(i), height_[index(i, j)], z_of(j));
    }
    const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(index(i, j)); };
    for (int j = 0; j + 1 < rows_; ++j) {
      for (int i = 0; i + 1 < columns_; ++i) {
        mesh.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
        mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
      }
    }
    mesh.material.assign(mesh.triangles.size(), cloth);
    return mesh;
  }

 private:
  static constexpr float kCell_m = 0.035F;

  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i);
  }
  float& at(int i, int j) { return height_[index(i, j)]; }
  float x_of(int i) const { return place_.low.x() + kCell_m * float(i); }
  float z_of(int j) const { return place_.low.y() + kCell_m * float(j); }
  template <class Use>
  void for_each(Use use) {
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) use(i, j);
    }
  }
  template <class Use>
  void around(int i, int j, Use use) const {
    for (int b = std::max(0, j - 1); b <= std::min(rows_ - 1, j + 1); ++b) {
      for (int a = std::max(0, i - 1); a <= std::min(columns_ - 1, i + 1); ++a) use(a, b);
    }
  }

  BlanketPlace place_;
  int columns_ = 0, rows_ = 0;
  std::vector<float> height_;
};

}  // namespace

void add_seat_cushions(const SeatShape& shape, float swell_m, Furniture& seat, Random& random) {
  SceneMesh& mesh = seat.mesh;
  const std::uint8_t cloth = add_material(mesh, sample_material(Stuff::cloth, random));
  const int count = std::max(1, int(shape.width_m / 0.6F));
  const float half = 0.5F * shape.width_m / float(count);
  const float thick = between(0.08, 0.13, random), high = 0.5F * shape.back_m * between(0.8, 1.1, random);
  const Isometry3f back(Eigen::Translation3f(0.F, shape.height_m, 0.F) *
                        AngleAxisf(-shape.lean_rad, Vector3f::UnitX()));
  for (int i = 0; i < count; ++i) {
    const float x = -0.5F * shape.width_m + half * float(2 * i + 1);
    const float rise = swell_m * between(0.7, 1.0, random);
    add_cushion(mesh, placed_at({x, shape.height_m + rise - 0.08F, 0.5F * shape.depth_m}),
                {1.02F * half, 0.08F, 0.5F * shape.depth_m + 0.02F}, cloth);
    add_cushion(mesh, back * Eigen::Translation3f(x, high + 0.3F * swell_m, swell_m - thick),
                {1.02F * half, high, thick}, cloth);
  }
  const int pillows = int(random.below(4));
  for (int i = 0; i < pillows; ++i) {
    const Vector3f size{between(0.16, 0.25, random), between(0.13, 0.22, random), between(0.05, 0.08, random)};
    Isometry3f pose = placed_at(
        {between(-0.45, 0.45, random) * shape.width_m, shape.height_m + 0.9F * size.y(), between(0.06, 0.16, random)});
    pose.rotate(AngleAxisf(between(-0.5, 0.5, random), Vector3f::UnitY()));
    pose.rotate(AngleAxisf(-between(0.1, 0.7, random), Vector3f::UnitX()));
    pose.rotate(AngleAxisf(between(-0.6, 0.6, random), Vector3f::UnitZ()));
    add_cushion(mesh, pose, size, add_material(mesh, sample_material(Stuff::cloth, random)));
  }
}

void add_soft_mattress(float width_m, float length_m, float height_m, float swell_m, Furniture& bed, Random& random) {
  const std::uint8_t cloth = add_material(bed.mesh, sample_material(Stuff::cloth, random));
  add_cushion(bed.mesh, placed_at({0.F, height_m + swell_m - 0.1F, 0.F}), {0.5F * width_m, 0.1F, 0.5F * length_m},
              cloth);
}

SceneMesh drape_blanket(const BlanketPlace& place, std::span<const Vector3f> body, Random& random) {
  constexpr int kSmoothings = 3;
  Cloth cloth(place, std::max(0.03F, place.ground_m - between(0.15, 0.6, random)));
  for (const Vector3f& p : body) cloth.cover(p);
  cloth.span();
  for (int i = 0; i < kSmoothings; ++i) cloth.smooth();
  cloth.wrinkle(random);
  return cloth.mesh(random);
}

}  // namespace vesalius::synth
