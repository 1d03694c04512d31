#include "synth/dress/garments.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kRound = 32;  // points of a ring

float uniform(Random& random, double low, double high) { return static_cast<float>(random.uniform(low, high)); }

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.F, 1.F);
  return t * t * (3.F - 2.F * t);
}

/// Ellipse in a level plane.
std::vector<Vector3f> ring(float y, float half_width, float front, float back) {
  std::vector<Vector3f> points;
  const float depth = (front - back) / 2.F;
  for (int k = 0; k < kRound; ++k) {
    const float turn = 2.F * kPi * static_cast<float>(k) / kRound;
    points.emplace_back(half_width * std::sin(turn), y, (front + back) / 2.F + depth * std::cos(turn));
  }
  return points;
}

}  // namespace

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
    const float y = std::lerp(top, bottom, static_cast<float>(r) / (kRows - 1));
    const Extent body = extent(y, 0.1F * size, {Bone::head, Bone::neck, Bone::chest});
    const float back =
        std::min(body.back, skull.back + 0.2F * size * static_cast<float>(r) / kRows) - thickness_m * 0.3F;
    const float wide = skull.half_width * std::lerp(0.98F, 0.8F, static_cast<float>(r) / (kRows - 1));
    std::vector<Vector3f> row;
    for (int k = 0; k <= 16; ++k) {
      const float turn = (static_cast<float>(k) / 16.F - 0.5F) * kPi;  // 0 at the back, the ears at the ends
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
    const float y = std::lerp(waist, hem, static_cast<float>(r) / (kRows - 1));
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
      // A cap's brim is in front only; elsewhere it shrinks to nothing.
      const float in_front = smooth_step(0.4F, 0.8F, std::cos(2.F * kPi * static_cast<float>(k) / kRound));
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

}  // namespace vesalius::synth
