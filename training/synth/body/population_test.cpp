#include "synth/body/population.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "synth/body/makehuman.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Population, MakesBodiesOfTheStaturesAskedFor) {
  for (const auto& [low, high] : {std::pair{1.F, 1.2F}, {1.5F, 1.6F}, {1.95F, 2.05F}}) {
    Population population;
    population.stature_min_m = low;
    population.stature_max_m = high;
    for (std::uint64_t i = 0; i < 8; ++i) {
      Random random(6, i);
      const BodyMesh body = make_body(builtin_bodies(), sample_factors(population, random), paper_body());
      EXPECT_GE(body.stature_m, low - 0.002F);
      EXPECT_LE(body.stature_m, high + 0.002F);
    }
  }
}

TEST(Population, HasTheSharesOfSexAndAge) {
  Population population;
  population.men = 0.8F;
  population.children = 0.6F;
  population.old = 0.F;
  int men = 0, children = 0;
  constexpr int kPeople = 2000;
  for (std::uint64_t i = 0; i < kPeople; ++i) {
    Random random(7, i);
    const MakeHumanFactors factors = sample_factors(population, random);
    men += factors.gender > 0.5F ? 1 : 0;
    children += factors.age_years < 18.F ? 1 : 0;
    EXPECT_LE(factors.age_years, 60.F);
  }
  EXPECT_NEAR(men / (1.0 * kPeople), 0.8, 0.03);
  EXPECT_NEAR(children / (1.0 * kPeople), 0.6, 0.04);
}

TEST(Population, KeepsToItsAgesEvenIfTheSharesHaveNobodyOfThem) {
  Population population;
  population.age_min_years = 5.F;
  population.age_max_years = 8.F;
  for (const float children : {0.F, 0.2F}) {
    population.children = children;
    for (std::uint64_t i = 0; i < 20; ++i) {
      Random random(9, i);
      const MakeHumanFactors factors = sample_factors(population, random);
      EXPECT_GE(factors.age_years, 5.F);
      EXPECT_LE(factors.age_years, 8.F);
      EXPECT_LT(factors.stature_m, 1.45F) << "a child's";
    }
  }
}

TEST(Population, HasChildrenAloneIfTheyAreAsked) {
  Population population;
  population.children = 1.F;
  for (std::uint64_t i = 0; i < 50; ++i) {
    Random random(12, i);
    EXPECT_LE(sample_factors(population, random).age_years, 18.F);
  }
}

TEST(Population, IsThinOrHeavyByItsBuild) {
  const auto mean_weight = [](float build) {
    Population population;
    population.build = build;
    double sum = 0.0;
    for (std::uint64_t i = 0; i < 800; ++i) {
      Random random(10, i);
      sum += static_cast<double>(sample_factors(population, random).weight);
    }
    return sum / 800.0;
  };
  EXPECT_LT(mean_weight(-1.F), 0.35);
  EXPECT_NEAR(mean_weight(0.F), 0.55, 0.03);
  EXPECT_GT(mean_weight(1.F), 0.75);
}

TEST(Population, NamesWhatIsWrong) {
  Population population;
  population.age_min_years = 91.F;
  EXPECT_THAT([&] { check(population); }, ThrowsMessage<UsageError>(HasSubstr("body.age-min")));
  population = {};
  population.stature_max_m = 0.8F;
  EXPECT_THAT([&] { check(population); }, ThrowsMessage<UsageError>(HasSubstr("body.stature-min")));
}

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
