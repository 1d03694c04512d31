#include "synth/scene/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "synth/furniture/gear.h"
#include "synth/furniture/make_furniture.h"
#include "synth/furniture/nobody.h"
#include "synth/furniture/pictures.h"
#include "synth/mesh/palette.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr int kTries = 6;

class Furnisher {
 public:
  Furnisher(const SceneOptions& options, const RoomShape& room, const Vector3f& eye, Occupancy& occupancy, Scene& scene,
            Random& random)
      : options_(options), room_(room), eye_(eye), occupancy_(occupancy), scene_(scene), random_(random) {}

  /// Places something between the camera and a person.
  void occlude(const Vector3f& person) {
    constexpr std::array<FurnitureKind, 8> kKinds = {FurnitureKind::table, FurnitureKind::chair, FurnitureKind::box,
                                                     FurnitureKind::plant, FurnitureKind::desk,  FurnitureKind::shelf,
                                                     FurnitureKind::table, FurnitureKind::pillar};
    constexpr float kMostHidden = 0.65F;
    const Furniture piece = asked(options_.gear_share, random_)
                                ? draw_gear()
                                : make_furniture(kKinds[random_.below(kKinds.size())], random_);
    for (int i = 0; i < kTries; ++i) {
      const Vector3f on_way = eye_ + between(0.3, 0.85, random_) * (person - eye_);
      const float x = on_way.x() + float(random_.normal(0.0, 0.3));
      const float z = on_way.z() + float(random_.normal(0.0, 0.3));
      if (put(piece, standing_at(x, 0.F, z, any_turn()), kMostHidden)) return;
    }
  }

  /// Puts a wall with an opening about a person or before them, so that its edge hides a part of them.
  void add_doorway(const Vector3f& person) {
    constexpr float kMostHidden = 0.7F;
    const Vector3f way(eye_.x() - person.x(), 0.F, eye_.z() - person.z());
    const float height = room_.open ? between(2.3, 3.0, random_) : room_.height_m;
    float widest = 2.2F;
    for (int i = 0; i < 2 * kTries; ++i, widest *= 0.85F) {
      const float ahead = std::min(between(-0.1, 0.6, random_), 0.4F * way.norm()),
                  edge = between(-0.15, 0.25, random_);
      const float side = chance(0.5, random_) ? 0.F : std::numbers::pi_v<float>;
      const float yaw = std::atan2(way.x(), way.z()) + side + between(-0.9, 0.9, random_);
      const Furniture wall = make_doorway(height, between(0.3, widest, random_), random_);
      const Vector3f at = Vector3f(person.x(), 0.F, person.z()) + ahead * way.normalized();
      if (put(wall, standing_at(at.x(), 0.F, at.z(), yaw) * Eigen::Translation3f(-edge, 0.F, 0.F), kMostHidden, true))
        return;
    }
  }

  void add_piece() {
    constexpr float kMostHidden = 0.35F;
    const Piece drawn = draw_piece();
    const bool at_wall = drawn.hangs || (!room_.open && chance(0.6, random_));
    for (int i = 0; i < kTries; ++i) {
      if (put(drawn.piece, at_wall ? place_at_wall(drawn.piece) : place_anywhere(), kMostHidden)) return;
    }
  }

  /// Hangs some pictures on the walls before the camera.
  void hang_pictures() {
    constexpr float kMostHidden = 0.05F, kWidest_rad = 0.6F;
    const int count = 1 + int(random_.below(5));
    for (int i = 0; i < count; ++i) {
      const Furniture picture = make_picture(random_);
      for (int k = 0; k < 4 * kTries; ++k) {
        const Isometry3f pose = place_at_wall(picture);
        const Vector3f way = pose.translation() - eye_;
        if (std::abs(std::atan2(way.x(), -way.z())) < kWidest_rad && put(picture, pose, kMostHidden, true)) break;
      }
    }
  }

  /// Places something large close to the camera, at the side.
  void loom() {
    constexpr std::array<FurnitureKind, 5> kKinds = {FurnitureKind::panel, FurnitureKind::panel, FurnitureKind::panel,
                                                     FurnitureKind::wardrobe, FurnitureKind::desk};
    constexpr float kMostHidden = 0.5F;
    constexpr std::array<NobodyKind, 6> kNobodies = {NobodyKind::board,   NobodyKind::board,   NobodyKind::board,
                                                     NobodyKind::machine, NobodyKind::machine, NobodyKind::screens};
    const bool nobody = asked(options_.near_nobody_share, random_);
    const Furniture piece = asked(options_.gear_share, random_) ? draw_gear()
                            : nobody ? make_nobody(kNobodies[random_.below(kNobodies.size())], random_)
                                     : make_furniture(kKinds[random_.below(kKinds.size())], random_);
    for (int i = 0; i < kTries; ++i) {
      const float far = between(0.45, 1.3, random_);
      const float bearing = between(0.15, 0.8, random_) * (chance(0.5, random_) ? 1.F : -1.F);
      const Isometry3f pose = standing_at(far * std::sin(bearing), 0.F, -far * std::cos(bearing), any_turn());
      if (put(piece, pose, kMostHidden, true)) return;
    }
  }

 private:
  /// A piece, and whether it hangs on a wall.
  struct Piece {
    Furniture piece;
    bool hangs = false;
  };

  float any_turn() { return between(-std::numbers::pi, std::numbers::pi, random_); }

  Furniture draw_gear() { return make_gear(static_cast<GearKind>(random_.below(kGearKindCount)), random_); }

  Piece draw_piece() {
    if (asked(options_.gear_share, random_)) return {draw_gear()};
    if (asked(options_.nobody_share, random_)) return draw_nobody();
    if (chance(options_.mannequin_share, random_)) {
      constexpr std::array<FurnitureKind, 3> kLike = {FurnitureKind::coat_stand, FurnitureKind::mannequin,
                                                      FurnitureKind::pillar};
      return {make_furniture(kLike[random_.below(kLike.size())], random_)};
    }
    constexpr auto kOrdinary = static_cast<std::uint32_t>(FurnitureKind::pillar);
    return {make_furniture(static_cast<FurnitureKind>(random_.below(kOrdinary)), random_)};
  }

  Piece draw_nobody() {
    auto kind = static_cast<NobodyKind>(random_.below(kNobodyKindCount));
    if (hangs_on_wall(kind) && room_.open) kind = NobodyKind::clothes_rack;
    return {make_nobody(kind, random_), hangs_on_wall(kind)};
  }

  Isometry3f place_at_wall(const Furniture& piece) {
    constexpr float kGap_m = 0.03F;
    float behind = 0.F;
    for (const OrientedBox& box : piece.solids) {
      for (const Vector3f& corner : corners(box)) behind = std::max(behind, -corner.z());
    }
    const std::uint32_t wall = random_.below(4);
    const bool along_x = wall % 2 == 0;
    const float inset = behind + kGap_m;
    const float share = between(0.0, 1.0, random_);
    const Eigen::Vector2f size = room_.high - room_.low;
    const float x = along_x     ? room_.low.x() + share * size.x()
                    : wall == 1 ? room_.high.x() - inset
                                : room_.low.x() + inset;
    const float z = !along_x    ? room_.low.y() + share * size.y()
                    : wall == 0 ? room_.low.y() + inset
                                : room_.high.y() - inset;
    constexpr std::array<float, 4> kQuarterTurns = {0.F, -1.F, 2.F, 1.F};  // turns the back to the wall
    return room_.world_from_room * standing_at(x, 0.F, z, kQuarterTurns[wall] * std::numbers::pi_v<float> / 2.F);
  }

  /// Draws a place in the camera's direction rather than behind it.
  Isometry3f place_anywhere() {
    const float far = between(0.6, 6.0, random_), bearing = between(-0.9, 0.9, random_);
    return standing_at(far * std::sin(bearing), 0.F, -far * std::cos(bearing), any_turn());
  }

  /// Returns whether the piece is so near that it would fill the picture.
  bool looms(const std::vector<OrientedBox>& solids) const {
    constexpr float kLarge_m = 0.35F;  // half the diagonal
    return std::ranges::any_of(solids, [&](const OrientedBox& box) {
      const Vector3f way = box.pose.translation() - eye_;
      return box.radius() > kLarge_m && way.norm() < 2.F * box.radius() + 0.2F && way.z() < 0.F;
    });
  }

  bool put(const Furniture& piece, const Isometry3f& pose, float most_hidden, bool may_loom = false) {
    std::vector<OrientedBox> solids;
    for (const OrientedBox& box : piece.solids) solids.push_back(moved(box, pose));
    if ((!may_loom && looms(solids)) || !occupancy_.free_for(solids) || occupancy_.hidden_share(solids) > most_hidden)
      return false;
    occupancy_.add(solids);
    move(scene_.meshes.emplace_back(piece.mesh), pose);
    return true;
  }

  const SceneOptions& options_;
  const RoomShape& room_;
  const Vector3f& eye_;
  Occupancy& occupancy_;
  Scene& scene_;
  Random& random_;
};

/// Adds lamps below the ceiling and ambient light.
void add_lights(const RoomShape& room, Scene& scene, Random& random) {
  constexpr float kFromWall_m = 0.5F;
  scene.ambient = between(0.3, 0.6, random);
  const int count = 1 + int(random.below(3));
  const float each = between(2.5, 5.0, random) / float(count);
  for (int i = 0; i < count; ++i) {
    Vector3f at{between(-3.0, 3.0, random), room.height_m - between(0.1, 0.5, random), between(-4.5, 0.5, random)};
    if (!room.open) {
      at.x() = between(room.low.x() + kFromWall_m, room.high.x() - kFromWall_m, random);
      at.z() = between(room.low.y() + kFromWall_m, room.high.y() - kFromWall_m, random);
      at = room.world_from_room * at;
    }
    scene.lights.push_back({at, each * between(0.7, 1.3, random)});
  }
}

/// Draws the colour outside: more often day than night, and dim beyond a hall's edge.
Rgb draw_sky(const RoomShape& room, Random& random) {
  const bool day = !room.open && chance(0.7, random);
  const float light = day ? between(0.7, 1.0, random) : between(0.02, 0.2, random);
  const float haze = between(0.8, 1.0, random);
  const auto level = [&](float share) { return static_cast<std::uint8_t>(255.F * light * share); };
  return {level(haze), level(0.5F * (1.F + haze)), level(1.F)};
}

/// Makes whole pieces black leather or lacquer, of which depth cameras see only blotches or nothing. The first mesh is
/// the room.
void darken_furniture(const SceneOptions& options, Scene& scene, Random& random) {
  constexpr std::size_t kRoom = 0;
  for (std::size_t i = kRoom + 1; i < scene.meshes.size(); ++i) {
    SceneMesh& mesh = scene.meshes[i];
    if (mesh.person >= 0 || !chance(options.dark_furniture, random)) continue;
    const auto factor = float(std::exp(random.uniform(std::log(0.015), std::log(0.15))));
    for (Material& material : mesh.materials) material.infrared *= factor;
    Random eye = random;  // all else stays the same with and without
    if (!chance(options.dark_to_the_eye, eye)) continue;
    const float left = between(0.05, 0.25, eye);
    for (Material& material : mesh.materials) {
      for (Rgb* colour : {&material.colour, &material.second}) *colour = scaled(*colour, left);
    }
  }
}

}  // namespace

RoomShape draw_room(const SceneOptions& options, const PlacedGroup* first, const ExtentOf& extent_of, Random& random) {
  constexpr float kWallGap_m = 0.02F, kSmallest_m = 1.8F;
  RoomShape room;
  room.open = chance(options.open_share, random);
  float yaw = between(-std::numbers::pi / 4, std::numbers::pi / 4, random);
  if (first != nullptr && chance(0.5, random)) {  // furniture in use often stands parallel to the walls
    const Vector3f front = first->world_from_group.linear().col(2);
    yaw = std::atan2(front.x(), front.z());
  }
  room.world_from_room = Isometry3f(Eigen::AngleAxisf(yaw, Vector3f::UnitY()));
  const bool wall_behind = first != nullptr && asked(options.wall_probability, random);
  if (wall_behind) {  // the room's back wall is where the camera sees the first people
    room.open = false;
    const Vector3f at = first->world_from_group.translation();
    room.world_from_room =
        Isometry3f(Eigen::AngleAxisf(std::atan2(-at.x(), -at.z()) + between(-0.4, 0.4, random), Vector3f::UnitY()));
  }
  const Isometry3f room_from_world = room.world_from_room.inverse();
  Eigen::AlignedBox3f extent = extent_of(room_from_world);
  if (!wall_behind) extent.extend(room_from_world * Vector3f(0.F, 0.F, -between(1.5, 5.0, random)));
  const auto spare = [&] { return kWallGap_m + (chance(0.25, random) ? 0.F : between(0.0, 3.0, random)); };
  const float left = spare();
  const float back = wall_behind ? kWallGap_m + between(0.0, options.wall_gap_max_m, random) : spare();
  const float right = spare(), front = spare();
  room.low = {extent.min().x() - left, extent.min().z() - back};
  room.high = {extent.max().x() + right, extent.max().z() + front};
  room.high = room.high.cwiseMax(room.low + Eigen::Vector2f::Constant(kSmallest_m));
  room.height_m = std::max(between(2.3, 3.2, random), extent.max().y() + 0.05F);
  return room;
}

void furnish(const SceneOptions& options, const RoomShape& room, const std::vector<Vector3f>& people,
             const Vector3f& eye, Occupancy& occupancy, Scene& scene, Random& random) {
  Furnisher furnisher(options, room, eye, occupancy, scene, random);
  for (const Vector3f& person : people) {
    if (asked(options.doorway_probability, random)) furnisher.add_doorway(person);
    if (chance(options.occluder_probability, random)) furnisher.occlude(person);
  }
  const int span = options.furniture_max - options.furniture_min + 1;
  const int count = options.furniture_min + int(random.below(span));
  for (int i = 0; i < count; ++i) furnisher.add_piece();
  if (chance(options.near_probability, random)) furnisher.loom();
  add_lights(room, scene, random);
  scene.sky = draw_sky(room, random);
  darken_furniture(options, scene, random);
  if (!room.open && asked(options.picture_probability, random)) furnisher.hang_pictures();
}

}  // namespace vesalius::synth
