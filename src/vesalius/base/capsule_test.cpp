#include "vesalius/base/capsule.h"

#include <gtest/gtest.h>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

TEST(Capsule, DistanceIsFromTheRoundedSurface) {
  const Capsule capsule{{0.F, 0.F, 2.F}, {1.F, 0.F, 2.F}, 0.1F, 0.3F};
  EXPECT_FLOAT_EQ(capsule.distance({0.5F, 1.F, 2.F}), 0.8F) << "the radius half way is 0.2";
  EXPECT_FLOAT_EQ(capsule.distance({-1.F, 0.F, 2.F}), 0.9F);
  EXPECT_FLOAT_EQ(capsule.distance({1.F, 0.F, 3.F}), 0.7F);
  EXPECT_FLOAT_EQ(capsule.distance({0.F, 0.F, 2.F}), -0.1F);
}

TEST(Capsule, ABallIsOneToo) {
  const Capsule ball{{0.F, 0.F, 1.F}, {0.F, 0.F, 1.F}, 0.5F, 0.5F};
  EXPECT_FLOAT_EQ(ball.distance({0.F, 2.F, 1.F}), 1.5F);
  EXPECT_FLOAT_EQ(ball.distance({0.F, 0.F, 1.F}), -0.5F);
}

TEST(Capsule, EveryPointIsSeenWithinTheBoxAroundIt) {
  const Camera camera{160, 120, 130.F, 140.F, 70.F, 65.F};
  Random random(3);
  const auto number = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
  int seen = 0;
  for (int round = 0; round < 200; ++round) {
    const Eigen::Vector3f from(number(-1.5, 1.5), number(-1.0, 1.0), number(0.2, 3.0));
    const Capsule capsule{from, from + Eigen::Vector3f(number(-0.5, 0.5), number(-0.5, 0.5), number(-0.1, 0.5)),
                          number(0.0, 0.3), number(0.0, 0.3)};
    const Box box = box_around(capsule, camera);
    ASSERT_GE(std::min({box.u, box.v, box.width, box.height}), 0);
    ASSERT_LE(box.u + box.width, camera.width);
    ASSERT_LE(box.v + box.height, camera.height);
    for (int v = 0; v < camera.height; v += 5) {
      for (int u = 0; u < camera.width; u += 5) {
        bool hit = false;
        for (float z = 0.1F; z < 4.F && !hit; z += 0.05F) {
          hit = capsule.distance(camera.point(static_cast<float>(u), static_cast<float>(v), z)) < 0.F;
        }
        if (!hit) continue;
        ++seen;
        EXPECT_TRUE(u >= box.u && u < box.u + box.width && v >= box.v && v < box.v + box.height) << u << ' ' << v;
      }
    }
  }
  EXPECT_GT(seen, 1000);
}

}  // namespace
}  // namespace vesalius
