#include "io/lens/colour_registration.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "io/lens/test_scenes.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using Eigen::Vector3d;

const Camera kDepth{160, 120, 150.F, 150.F, 79.5F, 59.5F};

/// A wall, and a board before it; each shows where it is hit by a colour of its own.
struct Scene {
  static constexpr double kWall_m = 3.0, kBoard_m = 1.2;

  /// Returns where a ray from `eye` first hits something.
  static Vector3d hit(const Vector3d& eye, const Vector3d& direction) {
    const Vector3d board = eye + direction * ((kBoard_m - eye.z()) / direction.z());
    if (std::abs(board.x()) < 0.2 && std::abs(board.y()) < 0.25) return board;
    return eye + direction * ((kWall_m - eye.z()) / direction.z());
  }
  static Rgb colour(const Vector3d& at) {
    const auto shade = [](double value) {
      return static_cast<std::uint8_t>(std::lround(150 + 80 * std::sin(3 * value)));
    };
    if (at.z() < 2.0) return {250, shade(at.x()), shade(at.y())};
    return {20, shade(at.x()), shade(at.y())};
  }
};

struct Rig {
  LensCamera colour;
  Eigen::Isometry3d colour_from_depth;
};

Rig rig(const char* model, const std::vector<double>& k) {
  Rig rig;
  rig.colour = {Camera{480, 270, 300.F, 298.F, 242.F, 131.F}, make_lens(model, k).value()};
  rig.colour_from_depth =
      Eigen::Translation3d(-0.15, 0.01, 0.02) * Eigen::AngleAxisd(0.05, Vector3d(0.3, 1.0, 0.2).normalized());
  return rig;
}

/// Renders the scene for both cameras.
Frame rendered(const Rig& of, ColourImage& colour) {
  const Eigen::Isometry3d depth_from_colour = of.colour_from_depth.inverse();
  colour = test::seen_through<Rgb>(of.colour, [&](const Eigen::Vector2d& ray) {
    return Scene::colour(Scene::hit(depth_from_colour.translation(), depth_from_colour.linear() * ray.homogeneous()));
  });
  Frame frame{"f", {}, kDepth, {}, {}};
  frame.depth = test::seen_through<std::uint16_t>({kDepth, {}}, [](const Eigen::Vector2d& ray) {
    return static_cast<std::uint16_t>(std::lround(1000 * Scene::hit(Vector3d::Zero(), ray.homogeneous()).z()));
  });
  return frame;
}

/// What the colour camera sees of the point that a pixel of depth shows; nothing if that is something else, or nothing.
std::optional<Rgb> truth(const Rig& rig, const Frame& frame, int u, int v) {
  const Vector3d point = point_at(kDepth, frame.depth, u, v).cast<double>();
  const Vector3d eye = rig.colour_from_depth.inverse().translation();
  const Vector3d first = Scene::hit(eye, point - eye);
  if ((first - point).norm() > 0.01) return std::nullopt;
  const Vector3d seen = rig.colour_from_depth * point;
  const auto bent = distort(rig.colour.lens, seen.head<2>() / seen.z());
  if (!bent) return std::nullopt;
  const Camera& camera = rig.colour.camera;
  const Eigen::Vector2f pixel = camera.pixel({static_cast<float>(bent->x()), static_cast<float>(bent->y()), 1.F});
  const bool inside = pixel.x() > -0.5F && pixel.y() > -0.5F && pixel.x() < static_cast<float>(camera.width) - 0.5F &&
                      pixel.y() < static_cast<float>(camera.height) - 0.5F;
  if (!inside) return std::nullopt;
  return Scene::colour(point);
}

class Registration : public testing::TestWithParam<int> {};

Rig rig_of(int i) {
  switch (i) {
    case 0:
      return rig("plumb_bob", {});
    case 1:
      return rig("plumb_bob", {-0.2, 0.05, 1e-3, -1e-3, 0});
    case 2:
      return rig("rational_polynomial", {0.5, -2.7, 6e-4, 2e-4, 1.6, 0.38, -2.5, 1.5});
    case 3:
      return rig("equidistant", {0.02, -0.01, 0.003, 0});
    default:
      return rig("modified_brown_conrady", {0.08, -0.05, 1e-3, 1e-3, 0});
  }
}

TEST_P(Registration, GivesEachPixelWhatTheColourCameraSeesThere) {
  const Rig rig = rig_of(GetParam());
  ColourImage colour;
  const Frame frame = rendered(rig, colour);
  const ColourImage registered = ColourRegistration(kDepth, rig.colour, rig.colour_from_depth)(frame.depth, colour);
  int seen = 0, hidden = 0;
  for (int v = 3; v < kDepth.height - 3; ++v) {
    for (int u = 3; u < kDepth.width - 3; ++u) {
      const std::optional<Rgb> should = truth(rig, frame, u, v);
      // At edges a pixel is as much one as the other.
      bool at_edge = false;
      for (int dv = -3; dv <= 3; ++dv) {
        for (int du = -3; du <= 3; ++du) {
          const auto other = truth(rig, frame, u + du, v + dv);
          at_edge |= other.has_value() != should.has_value() || (other && std::abs(other->r - should->r) > 100);
        }
      }
      const Rgb is = registered(u, v);
      if (at_edge) continue;
      if (!should) {
        ++hidden;
        ASSERT_EQ(is, Rgb{}) << u << " " << v;
      } else {
        ++seen;
        ASSERT_NEAR(is.r, should->r, 2) << u << " " << v;
        ASSERT_NEAR(is.g, should->g, 2) << u << " " << v;
        ASSERT_NEAR(is.b, should->b, 2) << u << " " << v;
      }
    }
  }
  EXPECT_GT(seen, 10000);
  EXPECT_GT(hidden, 50);
}

INSTANTIATE_TEST_SUITE_P(OfLenses, Registration, testing::Range(0, 5));

TEST(ColourRegistration, OfTheSameCameraLeavesColoursWhereTheyAre) {
  const Frame frame = test::random_frame("a", 1, 64, 48);
  const ColourImage registered =
      ColourRegistration(frame.camera, {frame.camera, {}}, Eigen::Isometry3d::Identity())(frame.depth, frame.colour);
  for (std::size_t i = 0; i < registered.size(); ++i) {
    ASSERT_EQ(registered[i], frame.depth[i] == 0 ? Rgb{} : frame.colour[i]);
  }
}

TEST(ColourRegistration, IsTheSameWithAnyNumberOfThreads) {
  const Rig rig = rig_of(1);
  ColourImage colour;
  const Frame frame = rendered(rig, colour);
  const ColourRegistration registration(kDepth, rig.colour, rig.colour_from_depth);
  const ColourImage with_all = registration(frame.depth, colour);
  const ThreadLimit one(1);
  EXPECT_EQ(registration(frame.depth, colour), with_all);
}

TEST(ColourRegistration, RefusesPicturesOfAnotherSize) {
  const Rig rig = rig_of(0);
  const ColourRegistration registration(kDepth, rig.colour, rig.colour_from_depth);
  EXPECT_THAT(test::error_of([&] { registration(DepthImage(160, 120), ColourImage(4, 3)); }),
              testing::HasSubstr("colour of 4x3 pixels, expected 480x270"));
}

}  // namespace
}  // namespace vesalius
