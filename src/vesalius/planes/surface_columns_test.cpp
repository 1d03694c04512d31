#include "vesalius/planes/surface_columns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"

namespace vesalius {
namespace {

struct Sample {
  Eigen::Vector3f point, normal;
  float thickness_m, area_m2;
};

Eigen::Vector3f random_vector(Random& random) {
  const auto number = [&] { return static_cast<float>(random.uniform(-1.0, 1.0)); };
  const float x = number(), y = number(), z = number();
  return {x, y, z};
}

/// Samples about the plane `normal . p = 1`, some too far from it or turned too far; their areas are 2^-8 and down to
/// 2^-`spread` of that, in square metres.
std::vector<Sample> random_samples(Random& random, const Eigen::Vector3f& normal, int count, double spread) {
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3f point = 3.F * random_vector(random);
    const Eigen::Vector3f on = point + normal * (1.F - normal.dot(point) + 0.03F * random_vector(random).x());
    samples.push_back({on, (normal + 0.5F * random_vector(random)).normalized(), 0.02F,
                       static_cast<float>(std::exp2(-8.0 - random.uniform(0.0, spread)))});
  }
  return samples;
}

SurfaceColumns columns_of(const std::vector<Sample>& samples) {
  SurfaceColumns columns;
  for (const Sample& s : samples) columns.add(s.point, s.normal, s.thickness_m, s.area_m2);
  return columns;
}

/// Area, not rounded to units.
double plain_support(const std::vector<Sample>& samples, const Eigen::Vector3f& normal, float offset) {
  double area = 0.0;
  for (const Sample& s : samples) {
    if (std::abs(normal.dot(s.point) - offset) > s.thickness_m || std::abs(normal.dot(s.normal)) < 0.85F) continue;
    const float slant = std::abs(normal.dot(s.point)) / s.point.norm();
    area += static_cast<double>(s.area_m2 / std::max(slant, 0.25F));
  }
  return area;
}

float support(const std::vector<Sample>& samples, const Eigen::Vector3f& normal) {
  return columns_of(samples).support(normal, 1.F, 0.85F, 0.25F);
}

void shuffle(std::vector<Sample>& samples, Random& random) {
  for (std::size_t i = samples.size(); i > 1; --i) {
    std::swap(samples[i - 1], samples[random.below(static_cast<std::uint32_t>(i))]);
  }
}

TEST(SurfaceColumns, SupportIsThePlainSumButForHalfAUnitASample) {
  Random random(5);
  for (const int count : {0, 1, 7, 8, 100, 5000}) {
    const Eigen::Vector3f normal = random_vector(random).normalized();
    const std::vector<Sample> samples = random_samples(random, normal, count, 8.0);
    const double expected = plain_support(samples, normal, 1.F);
    const double half_units = 0.5 * count / static_cast<double>(SurfaceColumns::kUnitsPerM2);
    EXPECT_NEAR(static_cast<double>(support(samples, normal)), expected, half_units + 1e-6 * expected) << count;
  }
}

TEST(SurfaceColumns, SupportIsTheSameOnEveryInstructionSetInAnyOrder) {
  Random random(6);
  for (int round = 0; round < 20; ++round) {
    const Eigen::Vector3f normal = random_vector(random).normalized();
    std::vector<Sample> samples = random_samples(random, normal, 1000 + round, 30.0);
    const float expected = support(samples, normal);
    EXPECT_GT(expected, 0.F);
    for_each_target([&](const char* target) {
      shuffle(samples, random);
      EXPECT_EQ(support(samples, normal), expected) << target << ' ' << round;
    });
  }
}

TEST(SurfaceColumns, AWallAheadCountsAsItIsAndASlantingOneAsLarger) {
  const Eigen::Vector3f ahead = Eigen::Vector3f::UnitZ();
  const std::vector<Sample> wall(10, {{0.F, 0.F, 1.F}, ahead, 0.02F, 0.125F});
  EXPECT_EQ(support(wall, ahead), 1.25F);
  EXPECT_EQ(support(wall, -ahead), 0.F);  // another plane, behind the camera
  const std::vector<Sample> slanting(10, {{0.F, 0.6F, 0.8F}, Eigen::Vector3f::UnitY(), 0.02F, 0.125F});
  EXPECT_NEAR(columns_of(slanting).support(Eigen::Vector3f::UnitY(), 0.6F, 0.85F, 0.25F), 1.25F / 0.6F, 1e-5F);
  EXPECT_EQ(columns_of(slanting).support(Eigen::Vector3f::UnitY(), 0.6F, 0.85F, 1.F), 1.25F);  // no further than that
}

TEST(SurfaceColumns, AreasBeyondAUnitsRangeAreTheLargestThereIs) {
  const Eigen::Vector3f ahead = Eigen::Vector3f::UnitZ();
  for (const int count : {1, 9, 100}) {
    const std::vector<Sample> huge(static_cast<std::size_t>(count), {{0.F, 0.F, 1.F}, ahead, 0.02F, 1e30F});
    for_each_target(
        [&](const char* target) { EXPECT_EQ(support(huge, ahead), 127.F * static_cast<float>(count)) << target; });
  }
}

}  // namespace
}  // namespace vesalius
