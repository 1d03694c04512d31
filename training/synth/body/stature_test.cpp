#include "synth/body/stature.h"

#include <gtest/gtest.h>

namespace vesalius::synth {
namespace {

TEST(Stature, AgreesWithTheTablesAndAnsur) {
  EXPECT_NEAR(stature_at(30.F, 0.F).mean_m, 1.629F, 1e-4F);
  EXPECT_NEAR(stature_at(30.F, 1.F).mean_m, 1.756F, 1e-4F);
  EXPECT_NEAR(stature_at(30.F, 0.F).sigma_m, 0.064F, 1e-3F);
  EXPECT_NEAR(stature_at(30.F, 1.F).sigma_m, 0.069F, 1e-3F);
  EXPECT_NEAR(stature_at(7.F, 1.F).mean_m, (1.155F + 1.280F) / 2.F, 1e-4F);
  EXPECT_NEAR(stature_at(6.F, 0.5F).mean_m, 1.153F, 1e-4F);
}

TEST(Stature, GrowsWithChildrenAndShrinksWithAge) {
  for (const float maleness : {0.F, 1.F}) {
    for (float age = 4.F; age < 18.F; age += 0.5F) {
      EXPECT_GT(stature_at(age + 0.5F, maleness).mean_m, stature_at(age, maleness).mean_m) << age;
    }
    for (float age = 41.F; age < 89.F; age += 1.F) {
      EXPECT_LT(stature_at(age + 1.F, maleness).mean_m, stature_at(age, maleness).mean_m) << age;
    }
  }
}

TEST(Stature, ClampsAges) {
  EXPECT_EQ(stature_at(-5.F, 0.F).mean_m, stature_at(4.F, 0.F).mean_m);
  EXPECT_EQ(stature_at(200.F, 2.F).mean_m, stature_at(90.F, 1.F).mean_m);
}

}  // namespace
}  // namespace vesalius::synth
