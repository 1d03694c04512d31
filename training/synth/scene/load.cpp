#include "synth/scene/load.h"

#include <algorithm>
#include <cmath>

#include "synth/furniture/care.h"
#include "synth/furniture/make_furniture.h"
#include "synth/mesh/palette.h"
#include "synth/scene/fit_support.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// The place of both hands in a frame on the floor below the hips, with +z to the front.
struct Hands {
  float middle_x = 0.F, half_width = 0.F;  ///< half the distance between the middles of the palms
  float low = 0.F, high = 0.F;             ///< heights of the lower and the higher palm
  float near_z = 0.F, far_z = 0.F;         ///< wrists, fingertips
};

Hands hands_of(const PosedBody& body, const Eigen::Isometry3f& hips_from_body) {
  const auto at = [&](const std::array<Vector3f, kBoneCount>& points, Bone bone) -> Vector3f {
    return hips_from_body * points[index(bone)];
  };
  const Vector3f l_wrist = at(body.joints, Bone::l_hand), r_wrist = at(body.joints, Bone::r_hand);
  const Vector3f l_tip = at(body.ends, Bone::l_hand), r_tip = at(body.ends, Bone::r_hand);
  const Vector3f left = 0.5F * (l_wrist + l_tip), right = 0.5F * (r_wrist + r_tip);
  return {0.5F * (left.x() + right.x()), 0.5F * std::abs(left.x() - right.x()), std::min(left.y(), right.y()),
          std::max(left.y(), right.y()), std::max(l_wrist.z(), r_wrist.z()),    std::min(l_tip.z(), r_tip.z())};
}

/// Returns the foremost point of the trunk between two heights near the middle.
float front_of_trunk(const BodyOutline& outline, const Eigen::Isometry3f& hips_from_body, float low, float high) {
  constexpr float kHalf_m = 0.08F;
  float front = 0.05F;
  const float reach = std::max((hips_from_body * outline.bones[index(Bone::chest)].from).z(), 0.F) + 0.22F;
  for (const Vector3f& point : outline.points) {
    const Vector3f p = hips_from_body * point;
    if (p.y() > low && p.y() < high && std::abs(p.x()) < kHalf_m && p.z() < reach) front = std::max(front, p.z());
  }
  return front;
}

/// Returns a box or a tray with things on it.
Furniture make_carried(const Hands& hands, float chest_z, float lift_m, Random& random) {
  FurnitureBuilder load(random);
  constexpr float kApart_m = 0.08F;
  const float draw = between(0.0, 1.0, random);
  const bool tray = draw > 0.75F;
  const bool between_hands = draw < 0.35F && hands.half_width > kApart_m;
  const float near = chest_z + between(0.01, 0.05, random);
  const float far = std::max(near + 0.15F, hands.far_z + between(-0.05, 0.12, random));
  const float half =
      between_hands ? hands.half_width - 0.035F : std::max(0.15F, hands.half_width + between(-0.05, 0.08, random));
  const float low = between_hands ? hands.low - between(0.03, 0.15, random) : hands.high + 0.035F + lift_m;
  const float tall = tray ? 0.015F : between(0.1, 0.4, random);
  const std::uint8_t stuff = load.stuff(tray                  ? Stuff::plastic
                                        : chance(0.7, random) ? Stuff::cardboard
                                                              : Stuff::plastic);
  load.box({hands.middle_x - half, low, near}, {hands.middle_x + half, low + tall, far}, stuff);
  if (tray) {
    FurnitureBuilder things(random);
    add_small_things(things, 0.8F * half, 0.4F * (far - near), low + tall, random);
    move(things.piece, standing_at(hands.middle_x, 0.F, 0.5F * (near + far), 0.F));
    join(load.piece, things.piece);
  }
  return std::move(load.piece);
}

}  // namespace

std::optional<Furniture> make_load(const PosedBody& body, const BodyOutline& outline, Random& random) {
  constexpr int kTries = 8;
  constexpr float kBefore_m = 0.25F, kWidest_m = 0.35F, kUneven_m = 0.15F, kWalker_m = 0.1F;
  const Eigen::Isometry3f body_from_floor = body_from_hips(body), floor_from_body = body_from_floor.inverse();
  const Hands hands = hands_of(body, floor_from_body);
  if (hands.far_z < kBefore_m || hands.half_width > kWidest_m || hands.high - hands.low > kUneven_m) {
    return std::nullopt;
  }
  const float chest = front_of_trunk(outline, floor_from_body, hands.low - 0.1F, hands.high + 0.3F);
  const float handle = 0.5F * (hands.low + hands.high);
  const bool may_push = handle > 0.65F && handle < 1.15F;
  for (int i = 0; i < kTries; ++i) {
    Furniture load;
    if (may_push && chance(0.5, random)) {
      load = (chance(0.5, random) && hands.half_width > kWalker_m ? make_walker : make_trolley)(handle, random);
      move(load, standing_at(hands.middle_x, 0.F, 0.5F * (hands.near_z + hands.far_z) + 0.04F * float(i), 0.F));
    } else {
      load = make_carried(hands, chest, 0.02F * float(i), random);
    }
    move(load, body_from_floor);
    if (!sinks_in(outline, load.solids)) return load;
  }
  return std::nullopt;
}

}  // namespace vesalius::synth
