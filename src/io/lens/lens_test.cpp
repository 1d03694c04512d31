#include "io/lens/lens.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "io/lens/test_scenes.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using Eigen::Vector2d;

Lens lens(const char* model, const std::vector<double>& k) { return make_lens(model, k).value(); }

TEST(Lens, BendsRaysAsItsModelSays) {
  const Vector2d radial = distort(lens("plumb_bob", {0.1, 0.02, 0, 0, 0.003}), {0.5, 0.0}).value();
  EXPECT_NEAR(radial.x(), 0.5 * (1 + 0.1 / 4 + 0.02 / 16 + 0.003 / 64), 1e-15);
  const Vector2d tangential = distort(lens("plumb_bob", {0, 0, 0.01, 0.002, 0}), {0.5, 0.25}).value();
  EXPECT_NEAR(tangential.x(), 0.5 + 2 * 0.01 * 0.125 + 0.002 * (0.3125 + 0.5), 1e-15);
  EXPECT_NEAR(tangential.y(), 0.25 + 0.01 * (0.3125 + 0.125) + 2 * 0.002 * 0.125, 1e-15);
  const Vector2d rational = distort(lens("rational_polynomial", {0.1, 0, 0, 0, 0, 0.3, 0, 0}), {0.0, 1.0}).value();
  EXPECT_NEAR(rational.y(), 1.1 / 1.3, 1e-15);
  const double eighth = std::atan(1.0);  // of a turn: a ray at 45 degrees
  const Vector2d fisheye = distort(lens("equidistant", {0.05, 0, 0, 0}), {0.6, 0.8}).value();
  EXPECT_NEAR(fisheye.norm(), eighth * (1 + 0.05 * eighth * eighth), 1e-15);
  EXPECT_NEAR(fisheye.y() / fisheye.x(), 0.8 / 0.6, 1e-12);
}

/// What rs2_project_point_to_pixel of librealsense 2.55 and 2.59 gives for this ray, by single precision.
TEST(Lens, BendsRaysAsLibrealsenseProjects) {
  const std::vector<double> k{0.1, -0.05, 0.01, 0.02, 0.03};
  const Vector2d ray(0.4, 0.3);
  for (const char* model : {"Modified Brown Conrady", "Inverse Brown Conrady"}) {
    EXPECT_LT((distort(lens(model, k), ray).value() - Vector2d(0.4231352, 0.3161014)).norm(), 1e-6) << model;
  }
  EXPECT_LT((distort(lens("Brown Conrady", k), ray).value() - Vector2d(0.4227375, 0.3158031)).norm(), 1e-6);
}

TEST(Lens, GivesBackTheRay) {
  for (const Lens& one : {lens("plumb_bob", {-0.28, 0.09, 1e-3, -5e-4, 0}),
                          lens("rational_polynomial", {0.5, -2.7, 6e-4, 2e-4, 1.6, 0.38, -2.5, 1.5}),
                          lens("kannala_brandt", {0.02, -0.01, 0.003, 0}),
                          lens("modified_brown_conrady", {-0.05, 0.06, 1e-3, 1e-3, -0.02}), Lens{}}) {
    const double most = std::min(0.9, 0.9 * one.reach);
    for (double angle = 0.1; angle < 6.3; angle += 0.4) {
      for (double length = 0.0; length < most; length += 0.05) {
        const Vector2d ray = length * Vector2d(std::cos(angle), std::sin(angle));
        const Vector2d back = undistort(one, distort(one, ray).value()).value();
        ASSERT_LT((back - ray).norm(), 1e-7) << ray.transpose();
      }
    }
  }
}

TEST(Lens, SeesNothingWhereItsPolynomialFoldsBack) {
  const Lens barrel = lens("plumb_bob", {-0.5, 0, 0, 0, 0});
  EXPECT_NEAR(barrel.reach, std::sqrt(1 / 1.5), 0.01);  // where r - r^3 / 2 is largest
  EXPECT_TRUE(distort(barrel, {0.5, 0.5}));
  EXPECT_FALSE(distort(barrel, {0.7, 0.7}));
  EXPECT_FALSE(distort(barrel, {std::nan(""), 0.0}));
}

TEST(MakeLens, KnowsTheNamesOfModels) {
  EXPECT_EQ(lens("plumb_bob", {0.1, 0, 0, 0, 0}).model, LensModel::brown_conrady);
  EXPECT_EQ(lens("", {0.1, 0, 0, 0, 0}), lens("Brown Conrady", {0.1}));
  EXPECT_EQ(lens("Kannala Brandt4", {0.1, 0, 0, 0, 0}).model, LensModel::kannala_brandt);
  EXPECT_EQ(lens("plumb_bob", {0, 0, 0, 0, 0}), Lens{});
  EXPECT_EQ(lens("none of these", {}), Lens{});
  EXPECT_FALSE(make_lens("none of these", {0.1}));
  EXPECT_FALSE(make_lens("plumb_bob", {0.1, 0, 0, 0, 0, 0.2})) << "plumb_bob has five coefficients";
  EXPECT_FALSE(make_lens("rational_polynomial", {0.1, 0, 0, 0, 0, 0, 0, 0, 0.2})) << "a thin prism";
  EXPECT_FALSE(make_lens("plumb_bob", {std::nan(""), 0, 0, 0, 0}));
}

using test::seen_through;

const Camera kCamera{160, 120, 140.F, 142.F, 78.F, 61.F};

std::vector<LensCamera> cameras() {
  return {{kCamera, make_lens("plumb_bob", {-0.25, 0.08, 2e-3, -1e-3, 0}).value()},
          {kCamera, make_lens("rational_polynomial", {0.5, -2.7, 6e-4, 2e-4, 1.6, 0.38, -2.5, 1.5}).value()},
          {kCamera, make_lens("equidistant", {0.02, -0.01, 0.003, 0}).value()},
          {kCamera, make_lens("modified_brown_conrady", {0.1, -0.05, 1e-3, 1e-3, 0}).value()}};
}

std::uint16_t on_a_slope(const Eigen::Vector2d& ray) {
  return static_cast<std::uint16_t>(std::lround(2000.0 / (1.0 + 0.4 * ray.x() - 0.3 * ray.y())));
}

TEST(Rectification, GivesTheDepthThatAPinholeCameraSees) {
  const DepthImage truth = seen_through<std::uint16_t>({kCamera, {}}, on_a_slope);
  for (const LensCamera& camera : cameras()) {
    const DepthImage depth = Rectification(camera, kCamera).depth(seen_through<std::uint16_t>(camera, on_a_slope));
    int seen = 0;
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        if (depth(u, v) == 0) continue;
        ++seen;
        // A reading comes from half a pixel aside in u and in v at most, which the lens squeezed by a third at the
        // border.
        const double z = truth(u, v), slope_mm = z * z / 2000 * (0.4 / 140 + 0.3 / 142);
        ASSERT_NEAR(depth(u, v), z, 0.5 * 1.5 * slope_mm + 1) << u << " " << v;
      }
    }
    EXPECT_GT(seen, 0.85 * static_cast<double>(truth.size()));
  }
}

TEST(Rectification, MixesNoDepths) {
  constexpr double kEdge = 0.15;
  const auto step = [](const Eigen::Vector2d& ray) {
    return static_cast<std::uint16_t>(ray.x() < kEdge ? 1000 : 2000);
  };
  for (const LensCamera& camera : cameras()) {
    const DepthImage depth = Rectification(camera, kCamera).depth(seen_through<std::uint16_t>(camera, step));
    for (int v = 10; v < kCamera.height - 10; ++v) {
      for (int u = 20; u < kCamera.width - 20; ++u) {
        const float x = kCamera.point(static_cast<float>(u), 0.F, 1.F).x();
        if (std::abs(x - static_cast<float>(kEdge)) < 1.F / kCamera.fx) {
          ASSERT_THAT(depth(u, v), testing::AnyOf(1000, 2000));
        } else {
          ASSERT_EQ(depth(u, v), x < static_cast<float>(kEdge) ? 1000 : 2000) << u << " " << v;
        }
      }
    }
  }
}

TEST(Rectification, GivesTheColourThatAPinholeCameraSees) {
  const auto shade = [](double value) { return static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * value)); };
  const auto pattern = [&](const Eigen::Vector2d& ray) {
    return Rgb{shade(std::sin(4 * ray.x())), shade(std::cos(5 * ray.y())), shade(ray.x() * ray.y())};
  };
  const ColourImage truth = seen_through<Rgb>({kCamera, {}}, pattern);
  for (const LensCamera& camera : cameras()) {
    const ColourImage colour = Rectification(camera, kCamera).colour(seen_through<Rgb>(camera, pattern));
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        const Rgb is = colour(u, v), should = truth(u, v);
        if (is == Rgb{}) continue;
        const bool inside = u > 15 && v > 15 && u < kCamera.width - 15 && v < kCamera.height - 15;
        const int most = inside ? 1 : 4;  // a border pixel has neighbours on one side only
        ASSERT_NEAR(is.r, should.r, most) << u << " " << v;
        ASSERT_NEAR(is.g, should.g, most) << u << " " << v;
        ASSERT_NEAR(is.b, should.b, most) << u << " " << v;
      }
    }
  }
}

TEST(Rectification, LeavesPicturesOfAPinholeCameraAsTheyAre) {
  const Frame frame = test::random_frame("a", 1, kCamera.width, kCamera.height);
  const Rectification same({kCamera, {}}, kCamera);
  EXPECT_EQ(same.depth(frame.depth), frame.depth);
  EXPECT_EQ(same.colour(frame.colour), frame.colour);
}

TEST(Rectification, IsTheSameWithAnyNumberOfThreads) {
  const LensCamera camera = cameras().front();
  const Frame frame = test::random_frame("a", 1, kCamera.width, kCamera.height);
  const ColourImage with_all = Rectification(camera, kCamera).colour(frame.colour);
  const ThreadLimit one(1);
  EXPECT_EQ(Rectification(camera, kCamera).colour(frame.colour), with_all);
}

TEST(Rectification, RefusesPicturesOfAnotherSize) {
  const Rectification same({kCamera, {}}, kCamera);
  EXPECT_THAT(test::error_of([&] { same.depth(DepthImage(4, 3)); }),
              testing::HasSubstr("4x3 pixels, expected 160x120"));
}

}  // namespace

}  // namespace vesalius
