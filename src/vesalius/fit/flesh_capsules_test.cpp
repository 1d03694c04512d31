#include "vesalius/fit/flesh_capsules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "vesalius/fit/test_flesh.h"

namespace vesalius {
namespace {

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
