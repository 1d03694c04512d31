#include "vesalius/track/smooth_joints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

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
