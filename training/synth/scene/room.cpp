#include "synth/scene/room.h"

#include <algorithm>
#include <vector>

#include "synth/mesh/palette.h"
#include "synth/mesh/scene_mesh.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

constexpr float kHall_m = 40.F;  ///< half the side of an open hall's floor, farther than any sensor sees

/// An opening in a wall: metres along it and above the floor.
struct Opening {
  float left, right, bottom, top;
  bool door;
};

struct Looks {
  std::uint8_t wall, frame, door, curtain, metal;
};

/// A wall as seen from inside. `along` runs from left to right at its foot, `in` points into the room.
class Wall {
 public:
  Wall(SceneMesh& mesh, const Vector3f& foot, const Vector3f& along, float length_m, float height_m, const Looks& looks)
      : mesh_(mesh), length_m_(length_m), height_m_(height_m), looks_(looks) {
    pose_.linear().col(0) = along;
    pose_.linear().col(1) = Vector3f::UnitY();
    pose_.linear().col(2) = along.cross(Vector3f::UnitY());
    pose_.translation() = foot;
  }

  void build(Random& random) {
    float cursor = 0.F;
    for (const Opening& opening : draw_openings(random)) {
      face(cursor, opening.left, 0.F, height_m_);
      skirting(cursor, opening.left);
      face(opening.left, opening.right, 0.F, opening.bottom);
      face(opening.left, opening.right, opening.top, height_m_);
      if (!opening.door) skirting(opening.left, opening.right);
      opening.door ? door(opening, random) : window(opening, random);
      cursor = opening.right;
    }
    face(cursor, length_m_, 0.F, height_m_);
    skirting(cursor, length_m_);
  }

 private:
  Vector3f at(float along, float up, float in = 0.F) const { return pose_ * Vector3f(along, up, in); }

  void face(float left, float right, float bottom, float top) {
    if (right - left < 1e-3F || top - bottom < 1e-3F) return;
    add_quad(mesh_, at(left, bottom), at(right, bottom), at(right, top), at(left, top), looks_.wall);
  }
  void bar(const Vector3f& low, const Vector3f& high, std::uint8_t material) {
    Eigen::Isometry3f pose = pose_;
    pose.translation() = pose_ * Vector3f(0.5F * (low + high));
    add_box(mesh_, pose, high - low, material);
  }
  void skirting(float left, float right) {
    if (right - left > 0.02F) bar({left, 0.F, 0.F}, {right, 0.07F, 0.012F}, looks_.frame);
  }
  void frame(const Opening& o) {
    constexpr float kWide = 0.05F, kDeep = 0.015F;
    bar({o.left - kWide, o.bottom, -0.05F}, {o.left, o.top, kDeep}, looks_.frame);
    bar({o.right, o.bottom, -0.05F}, {o.right + kWide, o.top, kDeep}, looks_.frame);
    bar({o.left - kWide, o.top, -0.05F}, {o.right + kWide, o.top + kWide, kDeep}, looks_.frame);
  }
  void door(const Opening& o, Random& random) {
    frame(o);
    if (chance(0.8, random)) {
      bar({o.left, 0.F, -0.05F}, {o.right, o.top, -0.02F}, looks_.door);
      bar({o.left + 0.07F, 1.02F, -0.02F}, {o.left + 0.19F, 1.04F, 0.035F}, looks_.metal);
      return;
    }
    const float deep = -between(0.9, 2.5, random);  // an open door to a corridor
    const Vector3f a = at(o.left, 0.F), b = at(o.right, 0.F), c = at(o.right, 0.F, deep), d = at(o.left, 0.F, deep);
    const Vector3f up(0.F, o.top, 0.F);
    add_quad(mesh_, a, b, c, d, looks_.door);
    add_quad(mesh_, d, c, c + up, d + up, looks_.wall);
    add_quad(mesh_, a, d, d + up, a + up, looks_.wall);
    add_quad(mesh_, c, b, b + up, c + up, looks_.wall);
    add_quad(mesh_, a + up, d + up, c + up, b + up, looks_.wall);
  }
  void window(const Opening& o, Random& random) {
    frame(o);
    bar({o.left - 0.06F, o.bottom - 0.03F, -0.05F}, {o.right + 0.06F, o.bottom, 0.06F}, looks_.frame);
    const int panes = 1 + int((o.right - o.left) / 0.8F);
    for (int i = 1; i < panes; ++i) {
      const float x = o.left + (o.right - o.left) * float(i) / float(panes);
      bar({x - 0.025F, o.bottom, -0.05F}, {x + 0.025F, o.top, -0.01F}, looks_.frame);
    }
    if (!chance(0.6, random)) return;
    const float drop = chance(0.5, random) ? o.top + 0.08F : o.top - o.bottom + 0.2F;
    const float share = chance(0.2, random) ? 0.5F : between(0.1, 0.3, random);
    const float wide = share * (o.right - o.left) + 0.1F, fold = between(0.03, 0.08, random);
    const int folds = std::max(2, int(wide / 0.12F));
    for (const float left : {o.left - 0.1F, o.right + 0.1F - wide}) {
      add_curtain(mesh_, at(left, o.top + 0.1F, 0.09F), at(left + wide, o.top + 0.1F, 0.09F), drop, fold, folds,
                  looks_.curtain);
    }
  }

  std::vector<Opening> draw_openings(Random& random) const {
    std::vector<Opening> openings;
    constexpr float kMargin = 0.3F;
    float cursor = kMargin + between(0.0, 1.0, random);
    while (cursor < length_m_ - kMargin) {
      const bool door = chance(0.3, random);
      const float wide = door ? between(0.75, 0.95, random) : between(0.6, 2.2, random);
      if (cursor + wide > length_m_ - kMargin) break;
      const float top = std::min(height_m_ - 0.15F, door ? between(1.95, 2.1, random) : between(1.9, 2.3, random));
      const float bottom = door ? 0.F : between(0.5, 1.1, random);
      if (chance(door ? 0.6 : 0.4, random)) openings.push_back({cursor, cursor + wide, bottom, top, door});
      cursor += wide + between(0.4, 2.5, random);
    }
    return openings;
  }

  SceneMesh& mesh_;
  float length_m_, height_m_;
  const Looks& looks_;
  Eigen::Isometry3f pose_ = Eigen::Isometry3f::Identity();
};

}  // namespace

float clearance(const RoomShape& room, const Vector3f& point) {
  if (room.open) return point.y();
  const Vector3f p = room.world_from_room.inverse() * point;
  const float sides =
      std::min({p.x() - room.low.x(), room.high.x() - p.x(), p.z() - room.low.y(), room.high.y() - p.z()});
  return std::min({sides, p.y(), room.height_m - p.y()});
}

SceneMesh make_room(const RoomShape& room, Random& random) {
  SceneMesh mesh;
  const std::uint8_t floor = add_material(mesh, sample_material(Stuff::floor, random));
  const Eigen::Vector2f low = room.open ? Eigen::Vector2f::Constant(-kHall_m) : room.low;
  const Eigen::Vector2f high = room.open ? Eigen::Vector2f::Constant(kHall_m) : room.high;
  const std::array<Vector3f, 4> feet = {Vector3f(low.x(), 0.F, low.y()), Vector3f(high.x(), 0.F, low.y()),
                                        Vector3f(high.x(), 0.F, high.y()), Vector3f(low.x(), 0.F, high.y())};
  add_quad(mesh, feet[0], feet[3], feet[2], feet[1], floor);
  if (!room.open) {
    const auto look = [&](Stuff stuff) { return add_material(mesh, sample_material(stuff, random)); };
    const Looks looks = {look(Stuff::wall), look(Stuff::paint), look(Stuff::wood), look(Stuff::cloth),
                         look(Stuff::metal)};
    const Vector3f up(0.F, room.height_m, 0.F);
    add_quad(mesh, feet[0] + up, feet[1] + up, feet[2] + up, feet[3] + up, look(Stuff::wall));
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector3f along = feet[(i + 1) % 4] - feet[i];
      Wall(mesh, feet[i], along.normalized(), along.norm(), room.height_m, looks).build(random);
    }
  }
  move(mesh, room.world_from_room);
  return mesh;
}

}  // namespace vesalius::synth
