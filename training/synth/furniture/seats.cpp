#include "synth/furniture/seats.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace vesalius::synth {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Vector3f;

/// Thickness of a board as a solid: boards are thin, but a body must not pass through.
constexpr float kSeatSolid_m = 0.08F;

void chair(const SeatShape& shape, FurnitureBuilder& seat, Random& random) {
  const std::uint8_t frame = seat.stuff(chance(0.6, random) ? Stuff::wood : Stuff::metal);
  const std::uint8_t cover = chance(0.5, random) ? frame : seat.stuff(Stuff::cloth);
  const float half = shape.width_m / 2, thick = between(0.02, 0.06, random), leg = between(0.025, 0.04, random);
  add_seat_board(seat, shape, thick, cover);
  if (chance(0.75, random)) {
    seat.legs(half, 0.F, shape.depth_m, shape.height_m - thick, leg, frame);
  } else {  // the star of an office chair
    const float z = shape.depth_m / 2;
    seat.post(0.F, z, 0.06F, shape.height_m - thick, 0.03F, frame);
    seat.box({-half * 0.9F, 0.02F, z - 0.03F}, {half * 0.9F, 0.07F, z + 0.03F}, frame);
    seat.box({-0.03F, 0.02F, z - half * 0.9F}, {0.03F, 0.07F, z + half * 0.9F}, frame);
  }
  const float thickness = between(0.02, 0.06, random), foot = between(0.0, 0.5, random) * shape.back_m;
  add_seat_back(seat, shape, shape.width_m * 0.95F, foot, thickness, cover);
  for (const float x : {-half * 0.8F, half * 0.8F}) {
    Isometry3f pose = seat_back_pose(shape, thickness, 0.F);
    pose.translation().x() = x;
    seat.box(pose, {leg, shape.back_m, 0.8F * thickness}, frame);
  }
}

void stool(const SeatShape& shape, FurnitureBuilder& seat, Random& random) {
  const std::uint8_t wood = seat.stuff(chance(0.6, random) ? Stuff::wood : Stuff::plastic);
  const float half = shape.width_m / 2, z = shape.depth_m / 2, thick = between(0.03, 0.07, random);
  add_seat_board(seat, shape, thick, wood);
  if (chance(0.5, random)) {
    seat.legs(half * 0.9F, 0.05F * z, 1.95F * z, shape.height_m - thick, 0.03F, wood);
  } else {
    seat.post(0.F, z, 0.F, shape.height_m - thick, 0.04F, wood);
    seat.post(0.F, z, 0.F, 0.03F, 0.8F * std::min(half, z), wood);
  }
}

/// Makes an armchair or a sofa: a base, a thick back and arms at both sides.
void upholstered(const SeatShape& shape, FurnitureBuilder& seat, Random& random) {
  const std::uint8_t cloth = seat.stuff(Stuff::cloth), feet = seat.stuff(Stuff::wood);
  const float half = shape.width_m / 2, arm = between(0.1, 0.2, random), thickness = between(0.12, 0.22, random);
  const float clear = std::min(0.5F * shape.height_m, between(0.02, 0.12, random));
  const float back_end = -thickness - std::sin(shape.lean_rad) * 0.1F;
  seat.box({-half, clear, back_end}, {half, shape.height_m - 0.1F, shape.depth_m - 0.01F}, cloth);
  const int cushions = std::max(1, int(shape.width_m / 0.6F));
  const float wide = shape.width_m / float(cushions);
  for (int i = 0; i < cushions; ++i) {
    const float x = -half + wide * float(i);
    seat.box({x + 0.003F, shape.height_m - 0.1F, 0.F}, {x + wide - 0.003F, shape.height_m, shape.depth_m}, cloth);
  }
  seat.box(seat_back_pose(shape, thickness, 0.F), {shape.width_m + 2.F * arm, shape.back_m, thickness}, cloth);
  const float arm_height = shape.height_m + between(0.12, 0.24, random);
  for (const float x : {-half - arm, half}) {
    seat.box({x, clear, back_end}, {x + arm, arm_height, shape.depth_m - 0.02F}, cloth);
  }
  seat.legs(half + arm, back_end, shape.depth_m, clear, 0.05F, feet);
}

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

Isometry3f seat_back_pose(const SeatShape& shape, float thickness, float foot) {
  Isometry3f pose = Isometry3f::Identity();
  pose.linear() = AngleAxisf(-shape.lean_rad, Vector3f::UnitX()).toRotationMatrix();
  const float length = shape.back_m - foot;
  pose.translation() =
      Vector3f(0.F, shape.height_m, 0.F) + pose.linear() * Vector3f(0.F, foot + 0.5F * length, -0.5F * thickness);
  return pose;
}

void solid_seat_board(FurnitureBuilder& seat, const SeatShape& shape) {
  const float half = shape.width_m / 2;
  seat.solid({-half, shape.height_m - kSeatSolid_m, 0.F}, {half, shape.height_m, shape.depth_m});
}

void add_seat_board(FurnitureBuilder& seat, const SeatShape& shape, float thickness, std::uint8_t material) {
  const float half = shape.width_m / 2;
  add_box(seat.piece.mesh, Vector3f(-half, shape.height_m - thickness, 0.F),
          Vector3f(half, shape.height_m, shape.depth_m), material);
  solid_seat_board(seat, shape);
}

void solid_seat_back(FurnitureBuilder& seat, const SeatShape& shape, float width, float foot, float thickness) {
  const float solid = std::max(thickness, kSeatSolid_m);
  seat.piece.solids.push_back({seat_back_pose(shape, solid, foot), 0.5F * Vector3f(width, shape.back_m - foot, solid)});
}

void add_seat_back(FurnitureBuilder& seat, const SeatShape& shape, float width, float foot, float thickness,
                   std::uint8_t material) {
  add_box(seat.piece.mesh, seat_back_pose(shape, thickness, foot), {width, shape.back_m - foot, thickness}, material);
  solid_seat_back(seat, shape, width, foot, thickness);
}

Furniture make_seat(const SeatShape& shape, Random& random) {
  FurnitureBuilder seat(random);
  switch (shape.kind) {
    case SeatKind::chair:
      chair(shape, seat, random);
      break;
    case SeatKind::stool:
      stool(shape, seat, random);
      break;
    case SeatKind::armchair:
    case SeatKind::sofa:
      upholstered(shape, seat, random);
      break;
  }
  return std::move(seat.piece);
}

Furniture make_bed(float width_m, float length_m, float height_m, Random& random) {
  FurnitureBuilder bed(random);
  const std::uint8_t wood = bed.stuff(Stuff::wood), sheet = bed.stuff(Stuff::cloth), pillow = bed.stuff(Stuff::cloth);
  const float x = width_m / 2, z = length_m / 2, mattress = std::min(0.2F, 0.5F * height_m);
  const float clear = std::min(0.1F, 0.3F * (height_m - mattress));
  bed.legs(x, -z, z, clear, 0.06F, wood);
  bed.box({-x, clear, -z}, {x, height_m - mattress, z}, wood);
  bed.box({-x + 0.01F, height_m - mattress, -z + 0.01F}, {x - 0.01F, height_m, z - 0.01F}, sheet);
  if (chance(0.7, random)) {
    const float top = height_m + between(0.1, 0.6, random);
    bed.box({-x, 0.F, z}, {x, top, z + between(0.03, 0.1, random)}, wood);
  }
  if (chance(0.3, random)) bed.box({-x, 0.F, -z - 0.04F}, {x, height_m + 0.1F, -z}, wood);
  if (chance(0.5, random)) {  // beside the place of the head; it is solid, so it is dropped if there is no room
    Isometry3f pose = Isometry3f::Identity();
    pose.translation() = Vector3f(0.F, height_m + 0.03F, z - 0.1F);
    const Vector3f half(std::min(0.3F, 0.8F * x), 0.06F, 0.12F);
    add_ellipsoid(bed.piece.mesh, pose, half, pillow, 8);
    bed.piece.solids.push_back({pose, 0.8F * half});
  }
  return std::move(bed.piece);
}

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
