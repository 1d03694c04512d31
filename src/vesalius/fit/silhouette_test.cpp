#include "vesalius/fit/silhouette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace vesalius {
namespace {

using Kind = Silhouette::Sight::Kind;

constexpr std::uint16_t kPerson_mm = 2000, kWall_mm = 4000;

/// A person's mask before a wall.
struct Scene {
  Frame frame;
  Mask mask;
};

/// Two discs and a slanting bar, so that nearest places lie in all directions.
Scene scene_of(int size) {
  Scene scene;
  const auto focal = static_cast<float>(size);
  const float middle = 0.5F * static_cast<float>(size - 1);
  scene.frame.camera = {size, size, focal, focal, middle, middle};
  scene.frame.depth = DepthImage(size, size, kWall_mm);
  scene.mask = Mask(size, size);
  for (int v = 0; v < size; ++v) {
    for (int u = 0; u < size; ++u) {
      const double x = static_cast<double>(u) / size, y = static_cast<double>(v) / size;
      const bool head = std::hypot(x - 0.5, y - 0.35) < 0.07, foot = std::hypot(x - 0.62, y - 0.68) < 0.05;
      const bool bar = std::abs(x - 0.4 - 0.3 * (y - 0.4)) < 0.04 && y > 0.35 && y < 0.7;
      if (!head && !foot && !bar) continue;
      scene.mask(u, v) = 1;
      scene.frame.depth(u, v) = kPerson_mm;
    }
  }
  return scene;
}

Eigen::Vector3d point(const Scene& scene, double u, double v, double z_m) {
  const Camera& camera = scene.frame.camera;
  return camera.point(static_cast<float>(u), static_cast<float>(v), static_cast<float>(z_m)).cast<double>();
}

/// Pixels from (u, v) to the nearest one of the mask.
double nearest_px(const Mask& mask, int u, int v) {
  double least = std::numeric_limits<double>::max();
  for (int row = 0; row < mask.height(); ++row) {
    for (int column = 0; column < mask.width(); ++column) {
      if (mask(column, row) != 0) least = std::min(least, std::hypot(column - u, row - v));
    }
  }
  return least;
}

TEST(Silhouette, FindsTheNearestPlaceOfThePerson) {
  // The grid's step is 1 pixel, and then 4: 0.4 * 300 pixels and 0.35 of that on both sides, in 64 places.
  for (const auto& [size, step] : {std::pair{100, 1}, {400, 4}}) {
    const Scene scene = scene_of(size);
    const Silhouette silhouette(scene.frame, scene.mask, bounding_box(scene.mask));
    int looked = 0;
    for (int v = size / 4; v < 3 * size / 4; v += size / 25) {
      for (int u = size / 4; u < 3 * size / 4; u += size / 25) {
        if (scene.mask(u, v) != 0) continue;
        ++looked;
        const Silhouette::Sight sight = silhouette.look(point(scene, u, v, 2.0), 0.05);
        ASSERT_EQ(sight.kind, Kind::behind) << u << ", " << v;
        const double found = sight.aside.norm(), nearest = nearest_px(scene.mask, u, v);
        // The place is truly the person's, and hardly farther than the nearest.
        const int at_u = static_cast<int>(std::lround(u + sight.aside.x()));
        const int at_v = static_cast<int>(std::lround(v + sight.aside.y()));
        EXPECT_NE(scene.mask(at_u, at_v), 0);
        EXPECT_GE(found, nearest - 1e-3);
        EXPECT_LE(found, nearest + 1.5 * step) << size << ": " << u << ", " << v;
      }
    }
    EXPECT_GT(looked, 50);
  }
}

TEST(Silhouette, TellsWhatTheCameraSees) {
  Scene scene = scene_of(100);
  scene.frame.depth(30, 50) = 1000;  // something before the person
  scene.frame.depth(70, 50) = 0;     // no reading
  scene.frame.depth(50, 35) = 0;     // none on the person either
  const Silhouette silhouette(scene.frame, scene.mask, bounding_box(scene.mask));
  const Silhouette::Sight on = silhouette.look(point(scene, 50.0, 32.0, 2.3), 0.05);
  EXPECT_EQ(on.kind, Kind::on);
  EXPECT_NEAR(on.depth_m, 2.0, 1e-6);
  EXPECT_EQ(silhouette.look(point(scene, 30.0, 50.0, 2.0), 0.05).kind, Kind::covered);
  EXPECT_EQ(silhouette.look(point(scene, 30.0, 50.0, 1.04), 0.05).kind, Kind::behind)
      << "nearer by less than the margin";
  EXPECT_EQ(silhouette.look(point(scene, 30.0, 55.0, 2.0), 0.05).kind, Kind::behind);
  EXPECT_EQ(silhouette.look(point(scene, 70.0, 50.0, 2.0), 0.05).kind, Kind::unknown);
  EXPECT_EQ(silhouette.look(point(scene, 50.0, 35.0, 2.0), 0.05).kind, Kind::unknown);
  EXPECT_EQ(silhouette.look(point(scene, -3.0, 50.0, 2.0), 0.05).kind, Kind::unknown) << "off the picture";
  EXPECT_EQ(silhouette.look(point(scene, 50.0, 120.0, 2.0), 0.05).kind, Kind::unknown);
  EXPECT_EQ(silhouette.look({0.0, 0.0, -1.0}, 0.05).kind, Kind::unknown) << "behind the camera";
}

TEST(Silhouette, OfNobodyTellsNothing) {
  Scene scene = scene_of(50);
  scene.mask.fill(0);
  const Silhouette silhouette(scene.frame, scene.mask, {});
  EXPECT_EQ(silhouette.look(point(scene, 5.0, 5.0, 2.0), 0.05).kind, Kind::unknown);
}

}  // namespace
}  // namespace vesalius
