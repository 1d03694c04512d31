#include "vesalius/track/track_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

TEST(TrackMotion, LearnsTheVelocityOfAnEvenWalk) {
  TrackMotion motion({0.F, 0.F, 3.F}, 0.05F);
  const Vector3f velocity(0.8F, 0.F, -0.5F);
  for (int i = 1; i <= 60; ++i) {
    motion.predict(1.0 / 30.0);
    motion.update(Vector3f(0.F, 0.F, 3.F) + velocity * (static_cast<float>(i) / 30.F), 0.05F);
  }
  EXPECT_NEAR((motion.velocity() - velocity).norm(), 0.F, 0.05F);
  EXPECT_NEAR((motion.position() - (Vector3f(0.F, 0.F, 3.F) + 2.F * velocity)).norm(), 0.F, 0.02F);
}

TEST(TrackMotion, IsTheSameInOneStepOrMany) {
  TrackMotion once({1.F, 2.F, 3.F}, 0.1F);
  once.predict(0.1);
  once.update({1.1F, 2.F, 3.F}, 0.1F);
  TrackMotion often = once;
  once.predict(0.6);
  for (int i = 0; i < 6; ++i) often.predict(0.1);
  EXPECT_NEAR((once.position() - often.position()).norm(), 0.F, 1e-5F);
  EXPECT_NEAR((once.velocity() - often.velocity()).norm(), 0.F, 1e-5F);
  EXPECT_NEAR(once.sigma_m(), often.sigma_m(), 1e-5F);
}

TEST(TrackMotion, GetsLessSureWhileNobodyIsSeenAndStopsInTheEnd) {
  TrackMotion motion({0.F, 0.F, 3.F}, 0.05F);
  for (int i = 1; i <= 30; ++i) {
    motion.predict(1.0 / 30.0);
    motion.update({static_cast<float>(i) / 30.F, 0.F, 3.F}, 0.05F);
  }
  float before = motion.sigma_m();
  motion.predict(0.2);
  EXPECT_NEAR(motion.velocity().x(), 1.F, 0.1F) << "it goes on at first";
  for (int i = 0; i < 10; ++i) {
    motion.predict(1.0);
    EXPECT_GT(motion.sigma_m(), before);
    before = motion.sigma_m();
  }
  EXPECT_LT(motion.velocity().norm(), 0.01F);
  EXPECT_LT(motion.position().x(), 1.F + 2.F) << "a walk of a metre a second ends within 0.25 and 1.5 s";
}

TEST(TrackMotion, MeasuresDistancesInItsOwnDeviations) {
  // What the model itself draws lies at a mean squared distance of 3, one for each axis.
  Random random(9);
  const auto noise = [&](double sigma) {
    const double x = random.normal(0.0, sigma), y = random.normal(0.0, sigma), z = random.normal(0.0, sigma);
    return Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  };
  double sum = 0.0;
  int count = 0;
  for (int run = 0; run < 400; ++run) {
    Vector3f position(0.F, 0.F, 3.F), velocity = noise(0.9);
    TrackMotion motion(position + noise(0.05), 0.05F);
    for (int i = 0; i < 20; ++i) {
      constexpr double kStep = 0.1, kPush = 2.0 * 0.9 * 0.9 / 1.5;
      const int parts = 20;
      for (int p = 0; p < parts; ++p) {
        position += velocity * static_cast<float>(kStep / parts);
        velocity += noise(std::sqrt(kPush * kStep / parts));
      }
      motion.predict(kStep);
      const Vector3f seen = position + noise(0.05);
      sum += static_cast<double>(motion.distance2(seen, 0.05F));
      ++count;
      motion.update(seen, 0.05F);
    }
  }
  EXPECT_NEAR(sum / count, 3.0, 0.15);
}

}  // namespace
}  // namespace vesalius
