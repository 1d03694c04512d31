#include "vesalius/fit/flesh_sections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "vesalius/fit/test_flesh.h"

namespace vesalius {
namespace {

FittedBody fitted(const BodyState& state) {
  FittedBody body;
  for (const PlacedBone& placed : place_bones(builtin_flesh(), state)) {
    FittedBone& bone = body.bones.emplace_back();
    bone.head = placed.head.cast<float>();
    bone.global = Eigen::Quaternionf(placed.global.cast<float>());
  }
  for (const double number : state.shape) body.shape.push_back(static_cast<float>(number));
  return body;
}

/// Returns the point of an ellipse that is nearest to the camera.
Eigen::Vector3f nearest(const FleshSection& section) {
  Eigen::Vector3f best = section.centre + section.first;
  for (int degrees = 0; degrees < 360; ++degrees) {
    const float t = static_cast<float>(degrees) * std::numbers::pi_v<float> / 180.F;
    const Eigen::Vector3f at = section.centre + std::cos(t) * section.first + std::sin(t) * section.second;
    if (at.z() < best.z()) best = at;
  }
  return best;
}

// The picture is drawn by other code, point by point.
TEST(FleshSections, LieOnTheBodyThatTheCameraSees) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const BodyState state = test::random_state(seed, 0.1);
    const test::SeenBody seen = test::see(state);
    const std::vector<BoneSections> all = flesh_sections(builtin_flesh(), fitted(state));
    ASSERT_EQ(all.size(), builtin_flesh().bones.size());
    int on_surface = 0, inside = 0;
    for (const BoneSections& bone : all) {
      for (const FleshSection& section : bone) {
        const Eigen::Vector3f at = nearest(section);
        const Eigen::Vector2f pixel = seen.frame.camera.pixel(at);
        const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
        if (!seen.frame.depth.contains(u, v)) continue;
        const float depth_m = 1e-3F * static_cast<float>(seen.frame.depth(u, v));
        EXPECT_LT(depth_m, at.z() + 0.03F) << "nothing stands out of the body";
        ++(std::abs(depth_m - at.z()) < 0.03F ? on_surface : inside);
      }
    }
    EXPECT_GT(on_surface, inside) << "the others are hidden by other limbs or by their neighbours";
  }
}

TEST(FleshCapsules, WhatTheCameraSeesOfABodyLiesOnThem) {
  for (const double yaw : {0.0, 0.8, 3.0}) {
    const BodyState state = test::usual_state(yaw);
    const std::vector<Capsule> capsules = flesh_capsules(builtin_flesh(), state);
    const test::SeenBody seen = test::see(state);
    int pixels = 0, near = 0;
    for (int v = 0; v < seen.frame.depth.height(); ++v) {
      for (int u = 0; u < seen.frame.depth.width(); ++u) {
        const Eigen::Vector3f point = point_at(seen.frame.camera, seen.frame.depth, u, v);
        float distance = std::numeric_limits<float>::max();
        for (const Capsule& capsule : capsules) distance = std::min(distance, capsule.distance(point));
        if (seen.person.mask(u, v) == 0) {
          EXPECT_GT(distance, 0.3F) << "the wall is far off";
          continue;
        }
        ++pixels;
        near += std::abs(distance) < 0.04F ? 1 : 0;
        EXPECT_LT(std::abs(distance), 0.12F) << u << ' ' << v;
      }
    }
    EXPECT_GT(near, 0.9 * pixels) << yaw;
  }
}

}  // namespace

}  // namespace vesalius
