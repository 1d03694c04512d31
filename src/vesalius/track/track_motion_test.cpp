#include "vesalius/track/track_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

TEST(TrackMotion, WhoeverFallsStopsAtTheFloor) {
  const FloorView floor{Vector3f(0.F, -0.8F, -0.6F), 1.F, 0.F, 0.F};
  const auto height_m = [&](const Vector3f& point) { return floor.height_m + floor.up.dot(point); };
  TrackMotion motion({0.F, -1.F, 2.F}, 0.05F);
  for (int i = 1; i <= 20; ++i) {
    motion.predict(1.0 / 30.0);
    motion.update(Vector3f(0.02F * float(i), -1.F, 2.F) - 0.025F * float(i) * floor.up, 0.05F);
    const Vector3f before = motion.position();
    motion.stop_at(floor);
    ASSERT_EQ(motion.position(), before) << "over the floor nothing changes";
  }
  TrackMotion falling = motion;
  falling.predict(0.8);
  motion.predict(0.8);
  ASSERT_LT(height_m(falling.position()), -0.1F) << "the test asks for something";
  motion.stop_at(floor);
  EXPECT_NEAR(height_m(motion.position()), 0.F, 1e-5F);
  EXPECT_NEAR(floor.up.dot(motion.velocity()), 0.F, 1e-5F);
  EXPECT_NEAR(motion.position().x(), falling.position().x(), 1e-6F) << "along the floor it goes on";
  EXPECT_NEAR(motion.velocity().x(), falling.velocity().x(), 1e-6F);
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

using Joints = std::vector<std::vector<Joint>>;
using Eigen::Vector3f;

constexpr double kFrame_s = 1.0 / 30.0;

Joints at(const Vector3f& position) { return {{{State::observed, position, 0.75F}}}; }

/// Seconds by which a joint lags that has moved evenly for a while.
float lag_s(float speed_m_s) {
  JointSmoother smoother;
  Vector3f raw = Vector3f::Zero(), smoothed = Vector3f::Zero();
  for (int i = 0; i < 300; ++i) {
    raw = {speed_m_s * static_cast<float>(i * kFrame_s), 0.F, 2.F};
    smoothed = smoother.smooth(at(raw), kFrame_s, {})[0][0].position;
  }
  return (raw - smoothed).x() / speed_m_s;
}

TEST(SmoothJoints, LagByWhatTheirCutoffSays) {
  // 1 / (2 pi (2 + 6 v)), as docs/tracking.md gives it.
  EXPECT_NEAR(lag_s(0.01F), 0.0773F, 0.003F);
  EXPECT_NEAR(lag_s(0.5F), 0.0318F, 0.002F);
  EXPECT_NEAR(lag_s(1.F), 0.0199F, 0.002F);
  EXPECT_NEAR(lag_s(3.F), 0.0080F, 0.002F);
}

TEST(SmoothJoints, AtRestTrembleLess) {
  Random random(2);
  JointSmoother smoother;
  double raw = 0.0, smoothed = 0.0;
  for (int i = 0; i < 600; ++i) {
    const auto off = [&] { return static_cast<float>(random.normal(0.0, 0.01)); };
    const float x = off(), y = off(), z = off();
    const Vector3f position(x, y, 2.F + z);
    const Vector3f out = smoother.smooth(at(position), kFrame_s, {})[0][0].position;
    if (i < 60) continue;
    raw += static_cast<double>((position - Vector3f(0.F, 0.F, 2.F)).squaredNorm());
    smoothed += static_cast<double>((out - Vector3f(0.F, 0.F, 2.F)).squaredNorm());
  }
  EXPECT_LT(std::sqrt(smoothed / raw), 0.55);
}

TEST(SmoothJoints, KeepWhatTheyAreAndBeginAnewAfterAGap) {
  JointSmoother smoother;
  const Joints first = smoother.smooth(at({0.F, 0.F, 2.F}), 0.0, {});
  EXPECT_EQ(first[0][0].position, Vector3f(0.F, 0.F, 2.F));
  EXPECT_EQ(first[0][0].state, State::observed);
  EXPECT_EQ(first[0][0].confidence, 0.75F);
  Joints none = at(Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  none[0][0].state = State::none;
  EXPECT_EQ(smoother.smooth(none, kFrame_s, {})[0][0].state, State::none);
  EXPECT_EQ(smoother.smooth(at({1.F, 0.F, 2.F}), kFrame_s, {})[0][0].position, Vector3f(1.F, 0.F, 2.F));
  EXPECT_EQ(smoother.smooth(at({5.F, 0.F, 2.F}), 0.0, {})[0][0].position, Vector3f(1.F, 0.F, 2.F)) << "no time passed";
}

TEST(SmoothJoints, DependLittleOnTheFrameRate) {
  JointSmoother fast, slow;
  Vector3f at_60 = Vector3f::Zero(), at_15 = Vector3f::Zero();
  for (int i = 0; i <= 120; ++i) {
    const float t = static_cast<float>(i) / 60.F;
    const Vector3f position(std::sin(2.F * t), 0.F, 2.F);
    at_60 = fast.smooth(at(position), 1.0 / 60.0, {})[0][0].position;
    if (i % 4 == 0) at_15 = slow.smooth(at(position), 1.0 / 15.0, {})[0][0].position;
  }
  EXPECT_NEAR((at_60 - at_15).norm(), 0.F, 0.04F);
}

}  // namespace

}  // namespace vesalius
