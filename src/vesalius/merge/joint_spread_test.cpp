#include "vesalius/merge/joint_spread.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

TEST(JointSpread, IsThatOfPointsOfWhichAsManyAreWithinTenCentimetres) {
  for (const float confidence : {0.1F, 0.35F, 0.5F, 0.77F, 0.95F}) {
    const double sigma = double(sigma_of(confidence));
    Random random(3);
    int within = 0;
    constexpr int kPoints = 20000;
    for (int i = 0; i < kPoints; ++i) {
      const double x = random.normal(0.0, sigma), y = random.normal(0.0, sigma), z = random.normal(0.0, sigma);
      within += std::sqrt(x * x + y * y + z * z) < 0.1 ? 1 : 0;
    }
    EXPECT_NEAR(double(within) / kPoints, double(confidence), 0.015) << confidence;
    EXPECT_NEAR(confidence_of(float(sigma)), confidence, 1e-4);
  }
}

TEST(JointSpread, IsFiniteForWhoIsSureOrKnowsNothing) {
  EXPECT_GT(sigma_of(1.F), 0.02F);
  EXPECT_LT(sigma_of(0.F), 0.4F);
  EXPECT_GT(confidence_of(0.F), 0.98F);
  EXPECT_LT(confidence_of(10.F), 0.02F);
}

}  // namespace
}  // namespace vesalius
