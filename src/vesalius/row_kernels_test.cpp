#include "vesalius/row_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"

namespace vesalius {
namespace {

DepthImage random_depth(const Camera& camera, Random& random) {
  DepthImage depth(camera.width, camera.height);
  for (std::uint16_t& mm : depth) mm = static_cast<std::uint16_t>(random.below(4) == 0 ? 0 : 900 + random.below(900));
  return depth;
}

TEST(SumBodies, AgreeWithPlainSumsOnEveryInstructionSet) {
  Random random(5);
  constexpr int kWidth = 37;
  for (const int parts : {1, 2, 7, 15, 16, 17, 24, 25, 31, 32, 40}) {
    Posteriors posteriors{.width = kWidth, .height = 2, .classes = parts + 1 + int(random.below(2)), .sums = {}};
    for (int i = 0; i < kWidth * 2 * posteriors.classes; ++i) {  // small ones, all of 16 bits
      posteriors.sums.push_back(static_cast<std::uint16_t>(random.below(random.below(2) == 0 ? 300 : 65536)));
    }
    std::fill_n(posteriors.at(3, 1), posteriors.classes, std::uint16_t{0});
    std::vector<std::uint8_t> skip(kWidth - 2);
    for (std::uint8_t& s : skip) s = random.below(5) == 0 ? 1 : 0;
    for_each_target([&](const char* target) {
      std::vector<BodySums> sums(skip.size(), BodySums{9, 9});
      sum_bodies(posteriors, 2, 1, parts, skip.data(), int(skip.size()), sums.data());
      for (std::size_t i = 0; i < skip.size(); ++i) {
        BodySums expected;
        for (int c = 0; skip[i] == 0 && c < posteriors.classes; ++c) {
          expected.all += posteriors.at(2 + int(i), 1)[c];
          if (c < parts) expected.body = expected.all;
        }
        ASSERT_EQ(sums[i].body, expected.body) << target << ' ' << parts << " parts, pixel " << i;
        ASSERT_EQ(sums[i].all, expected.all) << target << ' ' << parts << " parts, pixel " << i;
      }
    });
  }
}

TEST(MarkNear, AgreesWithThePointsOfPixelsOnEveryInstructionSet) {
  Random random(6);
  const Camera camera{61, 40, 55.F, 57.F, 30.2F, 19.7F};
  const DepthImage depth = random_depth(camera, random);
  for (int turn = 0; turn < 30; ++turn) {
    const int left = int(random.below(30)), top = int(random.below(20));
    const Box box{left, top, 1 + int(random.below(31)), 1 + int(random.below(20))};
    const Eigen::Vector3f at = camera.point(float(random.uniform(0.0, 61.0)), float(random.uniform(0.0, 40.0)), 1.3F);
    const float radius = float(random.uniform(0.05, 0.6));
    Mask expected(camera.width, camera.height, 0);
    expected(left, top) = 1;  // others have marked it
    const Mask before = expected;
    for (int v = top; v < top + box.height; ++v) {
      for (int u = left; u < left + box.width; ++u) {
        const bool near = (point_at(camera, depth, u, v) - at).squaredNorm() <= radius * radius;
        if (depth(u, v) != 0 && near) expected(u, v) = 1;
      }
    }
    for_each_target([&](const char* target) {
      Mask mask = before;
      mark_near(depth, camera, at, radius, box, mask);
      EXPECT_EQ(mask, expected) << target << ", turn " << turn;
    });
  }
}

TEST(LowerDistances, AgreesWithTheCapsulesOnEveryInstructionSet) {
  Random random(9);
  const auto number = [&](double low, double high) { return float(random.uniform(low, high)); };
  constexpr std::size_t kCount = 53;
  for (int turn = 0; turn < 30; ++turn) {
    PointRow points;
    std::vector<float> before;
    for (std::size_t i = 0; i < kCount; ++i) {
      points.x.push_back(number(-0.6, 0.6));
      points.y.push_back(number(-0.6, 0.6));
      points.z.push_back(random.below(5) == 0 ? 0.F : number(1.0, 2.2));
      before.push_back(random.below(3) == 0 ? number(-0.1, 0.3) : std::numeric_limits<float>::infinity());
    }
    const Eigen::Vector3f from(number(-0.5, 0.5), number(-0.5, 0.5), number(1.2, 1.8));
    const Eigen::Vector3f way(number(-0.4, 0.4), number(-0.4, 0.4), number(-0.2, 0.2));
    const Eigen::Vector3f to = turn == 0 ? from : Eigen::Vector3f(from + way);
    const Capsule capsule{from, to, number(0.0, 0.2), number(0.0, 0.2)};
    const std::size_t begin = random.below(20), end = begin + random.below(34);
    std::vector<float> expected = before;
    for (std::size_t i = begin; i < end; ++i) {
      if (points.z[i] == 0.F || points.z[i] < 1.1F || points.z[i] > 2.F) continue;
      const float d = capsule.distance({points.x[i], points.y[i], points.z[i]});
      if (d < 0.25F) expected[i] = std::min(expected[i], d);
    }
    for_each_target([&](const char* target) {
      std::vector<float> distance = before;
      lower_distances(points, begin, end, capsule, 1.1F, 2.F, 0.25F, distance.data());
      EXPECT_EQ(distance, expected) << target << ", turn " << turn;
    });
  }
}

/// Returns the hue of a colour in 72 steps.
int plain_hue(Rgb c) {
  const int high = std::max({c.r, c.g, c.b}), span = high - std::min({c.r, c.g, c.b});
  if (high < 24 || float(span) < 0.2F * float(high)) return 72 + high / 8;
  float sixth = 4.F + float(c.r - c.g) / float(span);
  if (high == c.g) sixth = 2.F + float(c.b - c.r) / float(span);
  if (high == c.r) sixth = float(c.g - c.b) / float(span);
  return (int(std::floor(sixth * 72.F / 6.F + 0.5F)) + 72) % 72;
}

TEST(ClassifyHues, AgreeWithPlainHuesOnEveryInstructionSet) {
  std::vector<Rgb> colours;
  const auto byte = [](std::uint32_t value) { return static_cast<std::uint8_t>(value); };
  for (std::uint32_t grey = 0; grey < 256; ++grey) colours.push_back({byte(grey), byte(grey), byte(grey)});
  for (std::uint32_t r = 0; r < 256; r += 15) {
    for (std::uint32_t g = 0; g < 256; g += 15) {
      for (std::uint32_t b = 0; b < 256; b += 15) colours.push_back({byte(r), byte(g), byte(b)});
    }
  }
  Random random(7);
  for (int i = 0; i < 20'000; ++i) {
    const std::uint32_t most = 1 + random.below(256);
    colours.push_back({byte(random.below(most)), byte(random.below(most)), byte(random.below(most))});
  }
  ASSERT_NE(colours.size() % 16, 0U) << "some are left for the end";
  for_each_target([&](const char* target) {
    std::vector<std::uint16_t> classes(colours.size(), 999);
    classify_hues(colours.data(), int(colours.size()), 72, classes.data());
    for (std::size_t i = 0; i < colours.size(); ++i) {
      const Rgb c = colours[i];
      ASSERT_EQ(classes[i], plain_hue(c)) << target << ": " << int{c.r} << ' ' << int{c.g} << ' ' << int{c.b};
    }
  });
}

}  // namespace
}  // namespace vesalius
