#include <gmock/gmock.h>

#include <limits>

#include "synth/sensor/render.h"
#include "synth/sensor/test_scenes.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Render, LabelsTrianglesWithoutAPartAsNobodys) {
  const View view = view_of(8, 8, 10.F);
  Scene scene;
  scene.meshes = {of_person(wall(2.F), 2)};
  scene.meshes[0].part = {kBackground, kBackground};
  const Rendering out = Renderer().render(scene, view);
  EXPECT_EQ(out.person(4, 4), kBackground);
  EXPECT_EQ(out.labels(4, 4), kBackground);
  EXPECT_EQ(out.depth_m(4, 4), 2.F);
}

TEST(Render, RendersAnEmptyScene) {
  const Rendering out = Renderer().render(Scene{}, view_of(8, 6, 10.F), {true, Vector3f(0.1F, 0.F, 0.F)});
  for (std::size_t i = 0; i < out.depth_m.size(); ++i) {
    ASSERT_EQ(out.depth_m[i], 0.F);
    ASSERT_EQ(out.lit[i], 0);
  }
}

TEST(Render, SeesNothingBehindTheCamera) {
  Scene scene;
  scene.meshes = {wall(-1.F), quad({-1.F, 1.F, -5.F}, {2.F, 0.F, 0.F}, {0.F, 0.F, 10.F})};  // a floor that passes below
  const View view = view_of(40, 31, 20.F);
  const Rendering out = Renderer().render(scene, view);
  for (int v = 0; v < 15; ++v) ASSERT_EQ(out.depth_m(20, v), 0.F);
  EXPECT_NEAR(out.depth_m(20, 30), 20.F / 15.F, 1e-5F);
}

void expect_error(const Scene& scene, const View& view, const std::string& words) {
  EXPECT_THAT([&] { Renderer().render(scene, view); }, ThrowsMessage<Error>(HasSubstr(words)));
}

TEST(Render, NamesTheFaultOfAScene) {
  const View view = view_of(8, 6, 10.F);
  Scene good;
  good.meshes = {wall(1.F), wall(2.F)};
  Scene bad = good;
  bad.meshes[1].triangles[1][2] = 4;
  expect_error(bad, view, "scene mesh 1: triangle 1 has vertex 4, expected less than 4");
  bad = good;
  bad.meshes[1].vertices[2].y() = std::numeric_limits<float>::quiet_NaN();
  expect_error(bad, view, "scene mesh 1: vertex 2 is not finite");
  bad = good;
  bad.meshes[0].part = {1};
  expect_error(bad, view, "scene mesh 0: 1 parts for 2 triangles");
  bad = good;
  bad.meshes[0].material = {0, 1};
  expect_error(bad, view, "material 1, expected less than 1");
  bad = good;
  bad.meshes[0].person = 255;
  expect_error(bad, view, "person 255, expected -1 to 254");
  bad = good;
  bad.meshes[0].materials = {Material{}};
  bad.meshes[0].materials[0].infrared = 1.5F;
  expect_error(bad, view, "infrared must be 0 to 1");
  bad = good;
  bad.lights = {Light{{0.F, std::numeric_limits<float>::infinity(), 0.F}, 1.F}};
  expect_error(bad, view, "light 0");
  View no_camera = view;
  no_camera.camera.fx = 0.F;
  EXPECT_THROW(Renderer().render(good, no_camera), Error);
  View huge = view;
  huge.camera.width = huge.camera.height = 1 << 20;
  expect_error(good, huge, "at most 67108864");
  View lost = view;
  lost.camera_from_world.translation().x() = std::numeric_limits<float>::quiet_NaN();
  expect_error(good, lost, "camera_from_world");
}

}  // namespace
}  // namespace vesalius::synth
