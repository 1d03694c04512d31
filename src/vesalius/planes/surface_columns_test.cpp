#include "vesalius/planes/surface_columns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vesalius/base/for_each_target.h"
#include "vesalius/base/random.h"

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

float plain_support(const std::vector<Sample>& samples, const Eigen::Vector3f& normal, float offset) {
  double area = 0.0;
  for (const Sample& s : samples) {
    if (std::abs(normal.dot(s.point) - offset) > s.thickness_m || std::abs(normal.dot(s.normal)) < 0.85F) continue;
    const float slant = std::abs(normal.dot(s.point)) / s.point.norm();
    area += static_cast<double>(s.area_m2 / std::max(slant, 0.25F));
  }
  return static_cast<float>(area);
}

/// `spread`: ratio of the largest area to the smallest, in powers of two.
void expect_plain_support(Random& random, int count, double spread) {
  std::vector<Sample> samples;
  SurfaceColumns columns;
  const Eigen::Vector3f normal = random_vector(random).normalized();
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3f point = 3.F * random_vector(random);
    const Eigen::Vector3f on = point + normal * (1.F - normal.dot(point) + 0.03F * random_vector(random).x());
    samples.push_back({on, (normal + 0.5F * random_vector(random)).normalized(), 0.02F,
                       static_cast<float>(std::exp2(-8.0 - random.uniform(0.0, spread)))});
    columns.add(samples.back().point, samples.back().normal, samples.back().thickness_m, samples.back().area_m2);
  }
  const float expected = plain_support(samples, normal, 1.F);
  for_each_target([&](const char* target) {
    EXPECT_EQ(columns.support(normal, 1.F, 0.85F, 0.25F), expected) << target << ' ' << count << ' ' << spread;
  });
}

TEST(SurfaceColumns, SupportIsThePlainSumOnEveryInstructionSet) {
  Random random(5);
  for (const int count : {0, 1, 7, 8, 100, 5000}) expect_plain_support(random, count, 8.0);
}

TEST(SurfaceColumns, AddsInOrderWhereSumsAreRounded) {
  Random random(6);
  for (int round = 0; round < 20; ++round) expect_plain_support(random, 3000, 60.0);
}

}  // namespace
}  // namespace vesalius
