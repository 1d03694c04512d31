#include "synth/dress/wardrobe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace vesalius::synth {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kRound = 32;  // number of points of a ring

float uniform(Random& random, double low, double high) { return float(random.uniform(low, high)); }

Matrix3f diagonal(float x, float y, float z) { return Vector3f(x, y, z).asDiagonal(); }

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.F, 1.F);
  return t * t * (3.F - 2.F * t);
}

/// Returns an ellipse in a level plane.
std::vector<Vector3f> ring(float y, float half_width, float front, float back) {
  std::vector<Vector3f> points;
  const float depth = (front - back) / 2.F;
  for (int k = 0; k < kRound; ++k) {
    const float turn = 2.F * kPi * float(k) / kRound;
    points.emplace_back(half_width * std::sin(turn), y, (front + back) / 2.F + depth * std::cos(turn));
  }
  return points;
}

}  // namespace

Wardrobe::Wardrobe(BodyMesh& mesh, BodyTopology& topology, SurfaceParts rules)
    : mesh_(mesh), topology_(topology), rules_(std::move(rules)), segments_(rest_bones(mesh)) {
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const auto whole = std::ranges::find_if(mesh.rig, [&](const RigBone& bone) {
      return bone.from == static_cast<Bone>(b) && (bone.blend == 0.F || bone.to == bone.from);
    });
    carrier_[b] = static_cast<std::uint16_t>(whole == mesh.rig.end() ? mesh.rig_of[b] : whole - mesh.rig.begin());
  }
  mover_.assign(mesh.vertices.size(), Bone::pelvis);
  const std::vector<Bone> bones = surface_bones(mesh);
  for (std::size_t t = 0; t < bones.size(); ++t) {
    for (const std::uint32_t v : topology.triangles[t]) mover_[v] = bones[t];
  }
}

void Wardrobe::add_long_hair(float thickness_m, Random& random) {
  const BoneSegment& head = segment(Bone::head);
  const float size = (head.tail - head.head).norm();
  const float shoulders = segment(Bone::neck).head.y();
  const float bottom = shoulders + uniform(random, -0.7, 0.2) * size;
  const float top = head.head.y() + 0.45F * size;
  const Extent skull = extent(top, 0.25F * size, {Bone::head});
  const float middle = (skull.front + skull.back) / 2.F;
  Sheet sheet;
  constexpr int kRows = 8;
  for (int r = 0; r < kRows; ++r) {
    const float y = std::lerp(top, bottom, float(r) / (kRows - 1));
    const Extent body = extent(y, 0.1F * size, {Bone::head, Bone::neck, Bone::chest});
    const float back = std::min(body.back, skull.back + 0.2F * size * float(r) / kRows) - thickness_m * 0.3F;
    const float wide = skull.half_width * std::lerp(0.98F, 0.8F, float(r) / (kRows - 1));
    std::vector<Vector3f> row;
    for (int k = 0; k <= 16; ++k) {
      const float turn = (float(k) / 16.F - 0.5F) * kPi;  // 0 is at the back; the ends are at the ears
      row.emplace_back(-wide * std::sin(turn), y, middle - (middle - back) * std::cos(turn));
    }
    sheet.rows.push_back(std::move(row));
  }
  const auto weights = [&](const Vector3f& p) {
    const float down = 0.6F * smooth_step(head.head.y(), shoulders - 0.4F * size, p.y());
    return skin({{Bone::head, 1.F - down}, {Bone::chest, down}});
  };
  const auto part = [&](const Vector3f& p) {
    return rules_.part(Bone::head, (p.y() - head.head.y()) / size, p.x() > 0.F);
  };
  add_sheet(sheet, weights, part, Fabric::hair);
}

void Wardrobe::add_skirts(float legs, Fabric fabric, Random& random) {
  const float hip = segment(Bone::l_thigh).head.y();
  const float knee = segment(Bone::l_thigh).tail.y();
  const float ankle = segment(Bone::l_shin).tail.y();
  const float waist = segment(Bone::spine).head.y() + 0.02F * mesh_.stature_m;
  const float hem = hip - legs * (hip - ankle);
  const float flare = uniform(random, 0.02, 0.25);
  Sheet sheet;
  sheet.closed = true;
  constexpr int kRows = 12;
  Extent widest;
  for (int r = 0; r < kRows; ++r) {
    const float y = std::lerp(waist, hem, float(r) / (kRows - 1));
    const Extent here = extent(y, 0.02F * mesh_.stature_m,
                               {Bone::pelvis, Bone::spine, Bone::l_thigh, Bone::r_thigh, Bone::l_shin, Bone::r_shin});
    widest.half_width = std::max(widest.half_width, here.half_width);
    widest.front = r == 0 ? here.front : std::max(widest.front, here.front);
    widest.back = r == 0 ? here.back : std::min(widest.back, here.back);
    const float room = (fabric == Fabric::top ? 0.024F : 0.012F) + flare * std::max(0.F, hip - y);
    sheet.rows.push_back(ring(y, widest.half_width + room, widest.front + room, widest.back - room));
  }
  const auto down = [=](const Vector3f& p) { return (hip - p.y()) / (hip - knee); };  // 0 at the hip, 1 at the knee
  const auto weights = [&](const Vector3f& p) {
    const float leg = smooth_step(-0.1F, 0.5F, down(p));
    const float shin = smooth_step(0.85F, 1.2F, down(p));
    const float left = smooth_step(-0.5F, 0.5F, p.x() / widest.half_width);
    if (shin == 0.F) {
      return skin({{Bone::pelvis, 1.F - leg}, {Bone::l_thigh, leg * left}, {Bone::r_thigh, leg * (1.F - left)}});
    }
    return skin({{Bone::l_thigh, (1.F - shin) * left},
                 {Bone::r_thigh, (1.F - shin) * (1.F - left)},
                 {Bone::l_shin, shin * left},
                 {Bone::r_shin, shin * (1.F - left)}});
  };
  const auto part = [&](const Vector3f& p) {
    const bool left = p.x() > 0.F;
    if (down(p) < 0.F) return rules_.part(Bone::pelvis, 0.5F, left);
    if (down(p) < 1.F) return rules_.part(left ? Bone::l_thigh : Bone::r_thigh, down(p), left);
    return rules_.part(left ? Bone::l_shin : Bone::r_shin, (knee - p.y()) / (knee - ankle), left);
  };
  add_sheet(sheet, weights, part, fabric);
}

void Wardrobe::add_hat(Hat hat, Random& random) {
  const BoneSegment& head = segment(Bone::head);
  const float size = (head.tail - head.head).norm();
  const float base = head.head.y() + uniform(random, 0.55, 0.7) * size;
  const Extent skull = extent(base, 0.1F * size, {Bone::head});
  float crown = base;
  for (std::size_t v = 0; v < mover_.size(); ++v) {
    if (mover_[v] == Bone::head) crown = std::max(crown, mesh_.vertices[v].y());
  }
  crown += hat == Hat::beanie ? uniform(random, 0.01, 0.03) : uniform(random, 0.02, 0.07);
  const float room = 0.008F;
  const float brim = hat == Hat::beanie ? 0.F : uniform(random, 0.05, 0.09);
  Sheet sheet;
  sheet.closed = true;
  struct Level {
    float up, scale;
  };
  for (const Level& level :
       {Level{1.F, 0.02F}, Level{0.95F, 0.5F}, Level{0.8F, 0.82F}, Level{0.5F, 0.97F}, Level{0.F, 1.F}}) {
    const float middle = (skull.front + skull.back) / 2.F;
    const float half = (skull.front - skull.back) / 2.F + room;
    sheet.rows.push_back(ring(std::lerp(base, crown, level.up), level.scale * (skull.half_width + room),
                              middle + level.scale * half, middle - level.scale * half));
  }
  if (brim > 0.F) {
    std::vector<Vector3f> edge =
        ring(base - 0.01F, skull.half_width + room + brim, skull.front + room + brim, skull.back - room - brim);
    for (std::size_t k = 0; hat == Hat::cap && k < edge.size(); ++k) {
      // The brim of a cap is only at the front; elsewhere it has no width.
      const float in_front = smooth_step(0.4F, 0.8F, std::cos(2.F * kPi * float(k) / kRound));
      edge[k] = sheet.rows.back()[k] + in_front * (edge[k] - sheet.rows.back()[k]);
    }
    sheet.rows.push_back(std::move(edge));
  }
  const auto part = [&](const Vector3f& p) { return rules_.part(Bone::head, 0.9F, p.x() > 0.F); };
  add_sheet(
      sheet,
      [&](const Vector3f&) {
        return skin({{Bone::head, 1.F}});
      },
      part, Fabric::accessory);
}

void Wardrobe::add_backpack(Random& random) {
  const BoneSegment& chest = segment(Bone::chest);
  const float high = uniform(random, 0.2, 0.28) * mesh_.stature_m / 2.F;
  const float deep = uniform(random, 0.1, 0.22) / 2.F;
  const float wide = uniform(random, 0.14, 0.19) * mesh_.stature_m / 2.F;
  const float y = std::lerp(chest.head.y(), chest.tail.y(), 0.45F);
  const float back = extent(y, high, {Bone::chest, Bone::spine}).back;
  add_box({0.F, y, back - deep}, diagonal(wide, high, deep), Bone::chest);
}

void Wardrobe::add_bag(Bag bag, bool left, Random& random) {
  const float high = uniform(random, 0.09, 0.18);
  const float wide = uniform(random, 0.1, 0.2);
  const float thick = uniform(random, 0.03, 0.07);
  if (bag == Bag::on_strap) add_strap(left);
  if (bag != Bag::in_hand) {
    const float y = segment(Bone::l_thigh).head.y();
    const float side = extent(y, high, {Bone::pelvis, Bone::l_thigh, Bone::r_thigh}).half_width + thick;
    add_box({left ? side : -side, y, 0.F}, diagonal(thick, high, wide), Bone::pelvis);
    return;
  }
  const Bone bone = left ? Bone::l_hand : Bone::r_hand;
  const Vector3f fingers = segment(bone).tail;
  add_box(fingers - Vector3f(0.F, high, 0.F), diagonal(thick, high, wide), hanging(bone, fingers));
}

void Wardrobe::add_held(Held held, bool left, Random& random) {
  const Bone bone = left ? Bone::l_hand : Bone::r_hand;
  const BoneSegment& hand = segment(bone);
  const Matrix3f axes = hand_axes(left);
  const Vector3f palm = 0.45F * hand.head + 0.55F * hand.tail;
  const auto in_palm = [&](float half_thickness) -> Vector3f { return palm + (half_thickness + 0.015F) * axes.col(1); };
  switch (held) {
    case Held::none:
      return;
    case Held::umbrella:
    case Held::broom:
    case Held::cane:
      return add_upright(held, left, random);
    case Held::cup: {
      const float radius = uniform(random, 0.03, 0.045);
      add_cylinder(in_palm(radius), uniform(random, 0.04, 0.07) * axes.col(2), radius, skin({{bone, 1.F}}));
      return;
    }
    case Held::phone:
      add_box(in_palm(0.005F), axes * diagonal(0.075F, 0.005F, 0.037F), bone);
      return;
    case Held::stick: {
      const float half = uniform(random, 0.15, 0.6);
      const float shift = uniform(random, -0.8, 0.8) * half;
      add_cylinder(in_palm(0.012F) + shift * axes.col(2), half * axes.col(2), uniform(random, 0.008, 0.018),
                   skin({{bone, 1.F}}));
      return;
    }
    case Held::box: {
      const float thick = uniform(random, 0.04, 0.15);
      add_box(in_palm(thick), axes * diagonal(uniform(random, 0.08, 0.2), thick, uniform(random, 0.08, 0.2)), bone);
      return;
    }
  }
}

void Wardrobe::add_strap(bool left) {
  constexpr int kRows = 14;
  constexpr float kWide_m = 0.022F, kNear_m = 0.035F, kGap_m = 0.008F;
  const float side = left ? 1.F : -1.F, hip = segment(Bone::l_thigh).head.y();
  const Vector3f shoulder = segment(left ? Bone::r_upper_arm : Bone::l_upper_arm).head;
  const float waist = extent(hip, 0.05F, {Bone::pelvis, Bone::l_thigh, Bone::r_thigh}).half_width;
  const auto weights = [&](const Vector3f& p) {
    const float up = smooth_step(segment(Bone::spine).head.y(), segment(Bone::chest).head.y(), p.y());
    return skin({{Bone::pelvis, 1.F - up}, {Bone::chest, up}});
  };
  for (const bool front : {true, false}) {
    Sheet sheet;
    float z = 0.F;
    for (int r = 0; r < kRows; ++r) {
      const float share = float(r) / (kRows - 1);
      const Vector3f on_way = share * Vector3f(side * waist - 0.65F * shoulder.x(), hip - shoulder.y(), 0.F) +
                              Vector3f(0.65F * shoulder.x(), shoulder.y() + 0.04F * (1.F - share), 0.F);
      bool found = false;
      for (std::size_t v = 0; v < mover_.size(); ++v) {
        const Vector3f& p = mesh_.vertices[v];
        if (std::abs(p.x() - on_way.x()) > kNear_m || std::abs(p.y() - on_way.y()) > kNear_m) continue;
        if (mover_[v] == Bone::head || mover_[v] == Bone::neck) continue;
        z = !found ? p.z() : front ? std::max(z, p.z()) : std::min(z, p.z());
        found = true;
      }
      const float out = z + (front ? kGap_m : -kGap_m);
      sheet.rows.push_back({{on_way.x(), on_way.y() + kWide_m, out}, {on_way.x(), on_way.y() - kWide_m, out}});
    }
    add_sheet(
        sheet, weights, [](const Vector3f&) { return kBackground; }, Fabric::accessory);
  }
}

void Wardrobe::add_upright(Held held, bool left, Random& random) {
  const Bone bone = left ? Bone::l_hand : Bone::r_hand;
  const Vector3f palm = 0.45F * segment(bone).head + 0.55F * segment(bone).tail + 0.02F * hand_axes(left).col(1);
  const SkinWeights weights = hanging(bone, palm);
  const float down = uniform(random, 0.38, 0.5) * mesh_.stature_m;
  const auto stick = [&](float low, float high, float radius) {
    add_cylinder(palm + Vector3f(0.F, 0.5F * (low + high), 0.F), Vector3f(0.F, 0.5F * (high - low), 0.F), radius,
                 weights);
  };
  if (held == Held::broom) {
    const float turn = uniform(random, 0.0, kPi), wide = uniform(random, 0.12, 0.2), tall = uniform(random, 0.02, 0.06);
    const Matrix3f head = Eigen::AngleAxisf(turn, Vector3f::UnitY()).toRotationMatrix() * diagonal(wide, tall, 0.03F);
    stick(-down, uniform(random, 0.2, 0.7), 0.012F);
    add_box(palm - Vector3f(0.F, down, 0.F), head, weights);
    return;
  }
  const bool umbrella = held == Held::umbrella;
  stick(-down, 0.04F, 0.01F);
  if (umbrella) stick(0.06F - down, -0.15F, uniform(random, 0.02, 0.045));
  add_box(palm + Vector3f(0.F, 0.04F, 0.F), diagonal(0.015F, 0.015F, 0.06F), weights);
}

Wardrobe::Extent Wardrobe::extent(float y, float reach_m, std::initializer_list<Bone> bones) const {
  Extent out;
  bool found = false;
  for (std::size_t v = 0; v < mover_.size(); ++v) {
    const Vector3f& p = mesh_.vertices[v];
    if (std::abs(p.y() - y) > reach_m || std::ranges::find(bones, mover_[v]) == bones.end()) continue;
    out.half_width = std::max(out.half_width, std::abs(p.x()));
    out.front = found ? std::max(out.front, p.z()) : p.z();
    out.back = found ? std::min(out.back, p.z()) : p.z();
    found = true;
  }
  return out;
}

void Wardrobe::add_sheet(const Sheet& sheet, const SkinAt& skin_at, const PartAt& part, Fabric fabric) {
  const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
  const std::size_t columns = sheet.rows.front().size();
  for (const auto& row : sheet.rows) {
    for (const Vector3f& p : row) {
      mesh_.vertices.push_back(p);
      topology_.skin.push_back(skin_at(p));
    }
  }
  for (std::size_t r = 0; r + 1 < sheet.rows.size(); ++r) {
    for (std::size_t k = 0; k + (sheet.closed ? 0 : 1) < columns; ++k) {
      const auto at = [&](std::size_t row, std::size_t column) {
        return first + static_cast<std::uint32_t>(row * columns + column % columns);
      };
      topology_.triangles.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
      topology_.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
      topology_.part.insert(topology_.part.end(), 2,
                            part((mesh_.vertices[at(r, k)] + mesh_.vertices[at(r + 1, k + 1)]) / 2.F));
      topology_.fabric.insert(topology_.fabric.end(), 2, fabric);
    }
  }
}

SkinWeights Wardrobe::hanging(Bone hand, const Vector3f& from) {
  RigBone bone;
  bone.name = "bag";
  bone.parent = carrier_[index(hand)];
  bone.head = from;
  bone.tail = from - Vector3f::UnitY();
  bone.hangs = true;
  mesh_.rig.push_back(bone);
  return {{static_cast<std::uint16_t>(mesh_.rig.size() - 1)}, {1.F}};
}

void Wardrobe::add_box(const Vector3f& centre, const Matrix3f& half_axes, Bone bone) {
  add_box(centre, half_axes, skin({{bone, 1.F}}));
}

void Wardrobe::add_box(const Vector3f& centre, const Matrix3f& half_axes, const SkinWeights& weights) {
  // The twelve triangles use corners that are numbered by the signs of x, y, z. They face outwards if the axes are
  // right-handed.
  constexpr std::array<Triangle, 12> kFaces{{{0, 2, 3},
                                             {0, 3, 1},
                                             {4, 5, 7},
                                             {4, 7, 6},
                                             {0, 1, 5},
                                             {0, 5, 4},
                                             {2, 6, 7},
                                             {2, 7, 3},
                                             {0, 4, 6},
                                             {0, 6, 2},
                                             {1, 3, 7},
                                             {1, 7, 5}}};
  const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
  const bool left_handed = half_axes.determinant() < 0.F;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto sign = [&](unsigned bit) { return (corner >> bit & 1U) != 0 ? 1.F : -1.F; };
    mesh_.vertices.push_back(centre + half_axes * Vector3f(sign(0), sign(1), sign(2)));
    topology_.skin.push_back(weights);
  }
  for (Triangle t : kFaces) {
    if (left_handed) std::swap(t[1], t[2]);
    topology_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    topology_.part.push_back(kBackground);
    topology_.fabric.push_back(Fabric::accessory);
  }
}

void Wardrobe::add_cylinder(const Vector3f& centre, const Vector3f& half_axis, float radius_m,
                            const SkinWeights& weights) {
  constexpr int kSides = 12;
  const Vector3f axis = half_axis.normalized();
  const Vector3f side = axis.unitOrthogonal();
  Sheet sheet;
  sheet.closed = true;
  // The rings without width at the ends are the lids.
  for (const auto& [along, wide] : {std::pair{1.F, 0.F}, {1.F, 1.F}, {-1.F, 1.F}, {-1.F, 0.F}}) {
    std::vector<Vector3f> row;
    for (int k = 0; k < kSides; ++k) {
      const Eigen::AngleAxisf turn(2.F * kPi * float(k) / kSides, axis);
      row.push_back(centre + along * half_axis + wide * radius_m * (turn * side));
    }
    sheet.rows.push_back(std::move(row));
  }
  add_sheet(
      sheet, [&](const Vector3f&) { return weights; }, [](const Vector3f&) { return kBackground; }, Fabric::accessory);
}

SkinWeights Wardrobe::skin(std::initializer_list<Influence> influences) const {
  SkinWeights out;
  std::size_t k = 0;
  for (const Influence& i : influences) {
    if (i.weight <= 0.F || k == 4) continue;
    out.bone[k] = carrier_[index(i.bone)];
    out.weight[k] = i.weight;
    ++k;
  }
  return out;
}

Matrix3f Wardrobe::hand_axes(bool left) const {
  const Bone hand = left ? Bone::l_hand : Bone::r_hand;
  const RigBone& rig = mesh_.rig[carrier_[index(hand)]];
  Matrix3f t_axes;  // in the T, palms face down and thumbs are in front
  t_axes << rest_direction(hand), -Vector3f::UnitY(), Vector3f::UnitZ();
  return rig.t_from_rest.conjugate().toRotationMatrix() * t_axes;
}

}  // namespace vesalius::synth
