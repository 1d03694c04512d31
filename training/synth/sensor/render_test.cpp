#include "synth/sensor/render.h"

#include <gmock/gmock.h>

#include <cmath>
#include <thread>

#include "synth/sensor/test_scenes.h"
#include "vesalius/parallel.h"

namespace vesalius::synth {
namespace {

using namespace test;

using Eigen::Vector3f;

TEST(Render, GivesAPlaneItsDepthAndNormalInEveryPixel) {
  View view = view_of(64, 48, 60.F);
  view.camera.cx = 20.3F;  // an off-centre camera gives the same result
  const Vector3f normal = Vector3f(0.3F, -0.5F, -1.F).normalized();
  const Vector3f foot(0.1F, 0.2F, 2.5F);
  const Vector3f along = normal.cross(Vector3f::UnitY()).normalized();
  const Vector3f up = along.cross(normal);
  Scene scene;
  scene.meshes = {quad(foot - 20.F * along - 20.F * up, 40.F * along, 40.F * up)};
  const Rendering out = Renderer().render(scene, view);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const Vector3f ray = view.camera.point(static_cast<float>(u), static_cast<float>(v), 1.F);
      const float expected = normal.dot(foot) / normal.dot(ray);
      ASSERT_NEAR(out.depth_m(u, v), expected, 1e-5F * expected) << u << ' ' << v;
      ASSERT_LT((out.normal(u, v) - normal).norm(), 1e-5F);
      ASSERT_EQ(out.labels(u, v), kBackground);
    }
  }
}

TEST(Render, RendersASphereOfManyTriangles) {
  const View view = view_of(160, 120, 150.F);
  const Vector3f centre(0.2F, -0.1F, 2.F);
  constexpr float kRadius = 0.5F;
  Scene scene;
  scene.meshes = {of_person(sphere(centre, kRadius, 200), 3)};
  const Rendering out = Renderer().render(scene, view);
  int hits = 0;
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      const Vector3f ray = view.camera.point(static_cast<float>(u), static_cast<float>(v), 1.F);
      const float b = ray.dot(centre), a = ray.squaredNorm();
      const float root = b * b - a * (centre.squaredNorm() - kRadius * kRadius);
      if (root < -1e-3F) {
        ASSERT_EQ(out.depth_m(u, v), 0.F);
        ASSERT_EQ(out.person(u, v), kBackground);
        ASSERT_TRUE(out.normal(u, v).isZero());
      } else if (root > 2e-2F) {  // not at the rim, where facets are seen edge-on
        const float z = (b - std::sqrt(root)) / a;
        ASSERT_NEAR(out.depth_m(u, v), z, 5e-4F);
        ASSERT_GT(out.normal(u, v).dot((z * ray - centre) / kRadius), 0.999F);
        ASSERT_EQ(out.person(u, v), 3);
        ASSERT_EQ(out.labels(u, v), kPart);
        ++hits;
      }
    }
  }
  EXPECT_GT(hits, 3000);
}

TEST(Render, CastsRaysThroughPixelCentres) {
  const View view = view_of(40, 30, 50.F);
  Scene scene;
  // The wall covers x >= 0.1 m at 2 m. Its edge is at u = 0.1 / 2 * 50 + 19.5 = 22, and 22.02 is to the right of it.
  scene.meshes = {wall(2.F, 0.1008F), wall(4.F)};
  const Rendering out = Renderer().render(scene, view);
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) ASSERT_FLOAT_EQ(out.depth_m(u, v), u <= 22 ? 4.F : 2.F) << u;
  }
}

TEST(Render, CastsAShadowAsWideAsTheDisparityOfAStep) {
  constexpr float kFocal = 525.F, kBaseline = 0.075F, kNear = 1.F, kFar = 2.F;
  const View view = view_of(640, 20, kFocal);
  Scene scene;
  scene.meshes = {wall(kNear, 0.0007F),
                  wall(kFar)};  // the near wall covers the right half, and its shadow falls to the left
  RenderOptions options;
  options.projector = Vector3f(kBaseline, 0.F, 0.F);
  const Rendering out = Renderer().render(scene, view, options);
  int dark = 0;
  for (int u = 0; u < 640; ++u) dark += out.lit(u, 10) == 0 ? 1 : 0;
  EXPECT_NEAR(dark, kFocal * kBaseline * (1.F / kNear - 1.F / kFar), 1.0);
  EXPECT_EQ(out.lit(319, 10), 0);
  EXPECT_NE(out.lit(320, 10), 0);

  options.projector = Vector3f(-kBaseline, 0.F, 0.F);  // from the other side the step hides its own shadow
  const Rendering other = Renderer().render(scene, view, options);
  for (int u = 0; u < 640; ++u) ASSERT_NE(other.lit(u, 10), 0) << u;
}

TEST(Render, ChangesLittleByOmittingShadowRays) {
  const View view = view_of(320, 240, 280.F);
  Scene scene;
  for (int i = 0; i < 6; ++i) {
    scene.meshes.push_back(
        sphere({static_cast<float>(i) * 0.5F - 1.2F, 0.3F, 1.5F + static_cast<float>(i) * 0.3F}, 0.2F, 40));
  }
  scene.meshes.push_back(wall(5.F));
  Renderer renderer;
  RenderOptions options;
  for (const float baseline : {0.075F, -0.075F}) {
    options.projector = Vector3f(baseline, 0.F, 0.F);
    const Rendering sparing = renderer.render(scene, view, options);
    options.projector->y() = 1e-6F;  // not in a row with the camera, so every pixel gets a ray
    const Rendering all = renderer.render(scene, view, options);
    int dark = 0, different = 0;
    for (std::size_t i = 0; i < all.lit.size(); ++i) {
      dark += all.lit[i] == 0 ? 1 : 0;
      different += all.lit[i] != sparing.lit[i] ? 1 : 0;
    }
    EXPECT_GT(dark, 1000);
    EXPECT_LT(different, dark / 100) << "of " << dark;
  }
}

TEST(Render, MirrorsTheImageOfAMirroredScene) {
  View view = view_of(160, 120, 140.F);
  view.camera.cx = 71.25F;
  view.camera_from_world.linear() = Eigen::AngleAxisf(0.2F, Vector3f(0.4F, 1.F, 0.3F).normalized()).toRotationMatrix();
  view.camera_from_world.translation() = Vector3f(0.1F, 0.3F, 0.2F);
  View other = view;
  other.camera.cx = 159.F - 71.25F;
  const Eigen::DiagonalMatrix<float, 3> flip(-1.F, 1.F, 1.F);
  other.camera_from_world.linear() = flip * view.camera_from_world.linear() * flip;
  other.camera_from_world.translation().x() *= -1.F;
  const Scene scene = confetti(2000);
  RenderOptions options;
  options.projector = Vector3f(0.075F, 0.F, 0.F);
  const Rendering a = Renderer().render(scene, view, options);
  options.projector = Vector3f(-0.075F, 0.F, 0.F);
  const Rendering b = Renderer().render(mirrored(scene), other, options);
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      ASSERT_EQ(a.depth_m(u, v), b.depth_m(159 - u, v)) << u << ' ' << v;
      ASSERT_EQ(a.labels(u, v), b.labels(159 - u, v));
      ASSERT_EQ(a.person(u, v), b.person(159 - u, v));
      ASSERT_EQ(a.normal(u, v), flip * b.normal(159 - u, v));
      ASSERT_EQ(a.lit(u, v), b.lit(159 - u, v));
    }
  }
}

bool same(const Rendering& a, const Rendering& b) {
  return a.depth_m == b.depth_m && a.labels == b.labels && a.person == b.person && a.normal == b.normal &&
         a.colour == b.colour && a.infrared == b.infrared && a.lit == b.lit;
}

// Labels: threads
TEST(Render, GivesTheSameBytesOnAnyThread) {
  const View view = view_of(160, 120, 140.F);
  Scene scene = confetti(20000);
  scene.lights = {Light{}};
  RenderOptions options;
  options.projector = Vector3f(0.05F, 0.01F, 0.F);
  Renderer renderer;
  const Rendering first = renderer.render(scene, view, options);
  renderer.render(confetti(10), view_of(30, 50, 20.F));  // must not affect the next picture
  EXPECT_TRUE(same(first, renderer.render(scene, view, options)));
  std::vector<Rendering> others(4);
  parallel_for(4, [&](int i) { others[i] = Renderer().render(scene, view, options); });
  for (const Rendering& other : others) EXPECT_TRUE(same(first, other));
}

// Labels: threads
TEST(Render, LeavesOtherThreadsTheirWork) {
  const int before = thread_count();
  Renderer renderer;
  renderer.render(confetti(100), view_of(32, 24, 30.F));
  EXPECT_EQ(thread_count(), before);
}

TEST(Render, ShowsTheSkyWhereThereIsNoSurface) {
  Scene scene;
  scene.sky = {10, 20, 30};
  scene.meshes = {wall(2.F, 0.F)};
  const Rendering out = Renderer().render(scene, view_of(8, 8, 10.F));
  EXPECT_EQ(out.colour(0, 4), scene.sky);
  EXPECT_NE(out.colour(7, 4), scene.sky);
  EXPECT_EQ(out.depth_m(0, 4), 0.F);
}

TEST(Render, ShadesByLambertsLaw) {
  const View view = view_of(3, 3, 10.F);
  Scene scene;
  scene.meshes = {wall(2.F)};
  scene.meshes[0].materials = {Material{{200, 100, 50}, {}, Texture::plain, 0.1F, 0.25F}};
  scene.ambient = 0.25F;
  scene.lights = {Light{{0.F, 0.F, 0.F}, 2.F}};  // at a distance of 2 m it adds 2 / 2^2
  const Rendering out = Renderer().render(scene, view);
  EXPECT_EQ(out.colour(1, 1), (Rgb{150, 75, 38}));
  EXPECT_EQ(out.infrared(1, 1), 0.25F);
  scene.lights[0].position.z() = 3.F;  // behind the wall
  EXPECT_EQ(Renderer().render(scene, view).colour(1, 1), (Rgb{50, 25, 13}));
  RenderOptions plain;
  plain.colour = false;
  EXPECT_TRUE(Renderer().render(scene, view, plain).colour.empty());
  EXPECT_TRUE(Renderer().render(scene, view, plain).lit.empty());
}

}  // namespace
}  // namespace vesalius::synth
