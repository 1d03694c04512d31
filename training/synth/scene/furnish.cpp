#include "synth/scene/furnish.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "synth/furniture/make_furniture.h"
#include "synth/furniture/nobody.h"
#include "synth/mesh/palette.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr int kTries = 6;

class Furnisher {
 public:
  Furnisher(const SceneOptions& options, const RoomShape& room, const Vector3f& eye, Occupancy& occupancy,
            Random& random)
      : options_(options), room_(room), eye_(eye), occupancy_(occupancy), random_(random) {}

  /// Places something between the camera and a person.
  void occlude(const Vector3f& person) {
    constexpr std::array<FurnitureKind, 8> kKinds = {FurnitureKind::table, FurnitureKind::chair, FurnitureKind::box,
                                                     FurnitureKind::plant, FurnitureKind::desk,  FurnitureKind::shelf,
                                                     FurnitureKind::table, FurnitureKind::pillar};
    constexpr float kMostHidden = 0.65F;
    Furniture piece = make_furniture(kKinds[random_.below(kKinds.size())], random_);
    for (int i = 0; i < kTries; ++i) {
      const Vector3f on_way = eye_ + between(0.3, 0.85, random_) * (person - eye_);
      const float x = on_way.x() + float(random_.normal(0.0, 0.3));
      const float z = on_way.z() + float(random_.normal(0.0, 0.3));
      if (put(piece, standing_at(x, 0.F, z, any_turn()), kMostHidden)) return;
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

  /// Places something large close to the camera, at the side.
  void loom() {
    constexpr std::array<FurnitureKind, 5> kKinds = {FurnitureKind::panel, FurnitureKind::panel, FurnitureKind::panel,
                                                     FurnitureKind::wardrobe, FurnitureKind::desk};
    constexpr float kMostHidden = 0.5F;
    constexpr std::array<NobodyKind, 6> kNobodies = {NobodyKind::board,   NobodyKind::board,   NobodyKind::board,
                                                     NobodyKind::machine, NobodyKind::machine, NobodyKind::screens};
    const bool nobody = asked(options_.near_nobody_share, random_);
    const Furniture piece = nobody ? make_nobody(kNobodies[random_.below(kNobodies.size())], random_)
                                   : make_furniture(kKinds[random_.below(kKinds.size())], random_);
    for (int i = 0; i < kTries; ++i) {
      const float far = between(0.45, 1.3, random_);
      const float bearing = between(0.15, 0.8, random_) * (chance(0.5, random_) ? 1.F : -1.F);
      const Isometry3f pose = standing_at(far * std::sin(bearing), 0.F, -far * std::cos(bearing), any_turn());
      if (put(piece, pose, kMostHidden, true)) return;
    }
  }

  std::vector<Furniture> take() { return std::move(placed_); }

 private:
  /// A piece, and whether it hangs on a wall.
  struct Piece {
    Furniture piece;
    bool hangs = false;
  };

  float any_turn() { return between(-std::numbers::pi, std::numbers::pi, random_); }

  Piece draw_piece() {
    if (asked(options_.nobody_share, random_)) return draw_nobody();
    if (chance(options_.mannequin_share, random_)) {
      constexpr std::array<FurnitureKind, 3> kLike = {FurnitureKind::coat_stand, FurnitureKind::mannequin,
                                                      FurnitureKind::pillar};
      return {make_furniture(kLike[random_.below(kLike.size())], random_)};
    }
    constexpr std::uint32_t kOrdinary = static_cast<std::uint32_t>(FurnitureKind::pillar);
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
    placed_.push_back(piece);
    move(placed_.back(), pose);
    return true;
  }

  const SceneOptions& options_;
  const RoomShape& room_;
  Vector3f eye_;
  Occupancy& occupancy_;
  Random& random_;
  std::vector<Furniture> placed_;
};

}  // namespace

std::vector<Furniture> furnish(const SceneOptions& options, const RoomShape& room, const std::vector<Vector3f>& people,
                               const Vector3f& eye, Occupancy& occupancy, Random& random) {
  Furnisher furnisher(options, room, eye, occupancy, random);
  for (const Vector3f& person : people) {
    if (chance(options.occluder_probability, random)) furnisher.occlude(person);
  }
  const int span = options.furniture_max - options.furniture_min + 1;
  const int count = options.furniture_min + int(random.below(span));
  for (int i = 0; i < count; ++i) furnisher.add_piece();
  if (chance(options.near_probability, random)) furnisher.loom();
  return furnisher.take();
}

}  // namespace vesalius::synth
