#include "synth/scene/build_scene.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "synth/scene/test_plans.h"
#include "synth/sensor/render.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(BuildScene, ShowsPeopleUnderTheirOwnNumber) {
  Renderer renderer;
  int seen = 0, all = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const BuiltScene built = build(2000 + i, 2);
    const Rendering out = renderer.render(built.scene, built.view);
    for (std::size_t k = 0; k < built.people.size(); ++k) {
      ++all;
      EXPECT_EQ(built.scene.meshes[built.people[k].mesh].person, static_cast<int>(k));
      seen += std::ranges::count(out.person, static_cast<std::uint8_t>(k)) > 30 ? 1 : 0;
    }
  }
  EXPECT_GE(seen, all * 9 / 10);
}

TEST(BuildScene, ShowsTheLeftHandOfAFacingPersonOnTheRight) {
  SceneOptions options;
  options.furniture_max = 0;
  options.occluder_probability = 0.F;
  options.min_visible = 0.9F;
  CameraPlacement upright;
  upright.roll_max_deg = 0.F;
  PersonPlan plan = plan_of({}, 0);
  for (const float yaw : {0.F, 3.14159F}) {
    plan.yaw_rad = yaw;
    const BuiltScene built = build_scene(options, upright, kCamera, {plan}, Random(5));
    ASSERT_EQ(built.people.size(), 1U);
    const auto column = [&](Bone bone) {
      return kCamera.pixel(built.view.camera_from_world * built.people[0].body.joints[index(bone)]).x();
    };
    EXPECT_EQ(column(Bone::l_hand) > column(Bone::r_hand), yaw == 0.F);
    EXPECT_LT(kCamera.pixel(built.view.camera_from_world * built.people[0].body.ends[index(Bone::head)]).y(),
              kCamera.pixel(built.view.camera_from_world * built.people[0].body.ends[index(Bone::l_foot)]).y());
  }
}

// Labels: statistics
TEST(BuildScene, FollowsTheFrontalShare) {
  int frontal = 0, all = 0;
  SceneOptions options;
  options.furniture_max = 0;
  for (std::uint64_t i = 0; i < 800; ++i) {
    const BuiltScene built = build_scene(options, {}, kCamera, {plan_of({}, 0)}, Random(6, i));
    for (const PlacedPerson& person : built.people) {
      Vector3f to_camera = -person.world_from_body.translation();
      to_camera.y() = 0.F;
      const float cosine = to_camera.normalized().dot(person.world_from_body.linear().col(2));
      frontal += cosine > 0.5F ? 1 : 0;
      ++all;
    }
  }
  // 45 % face the camera on purpose and a third of the others by chance; the tolerance is five standard deviations.
  const double expected = 0.45 + 0.55 / 3.0;
  EXPECT_NEAR(frontal / static_cast<double>(all), expected, 5.0 * std::sqrt(expected * (1.0 - expected) / all));
}

bool same(const BuiltScene& a, const BuiltScene& b) {
  if (a.scene.meshes.size() != b.scene.meshes.size()) return false;
  for (std::size_t m = 0; m < a.scene.meshes.size(); ++m) {
    if (a.scene.meshes[m].vertices != b.scene.meshes[m].vertices) return false;
    if (a.scene.meshes[m].triangles != b.scene.meshes[m].triangles) return false;
  }
  return a.view.camera_from_world.matrix() == b.view.camera_from_world.matrix();
}

TEST(BuildScene, DependsOnTheSeedAlone) {
  EXPECT_TRUE(same(build(7, 3), build(7, 3)));
  EXPECT_FALSE(same(build(7, 3), build(8, 3)));
}

TEST(BuildScene, LeavesEmptyRoomsWithoutPeople) {
  const BuiltScene built = build(9, 0);
  EXPECT_TRUE(built.people.empty());
  EXPECT_GE(built.scene.meshes.size(), 1U);
  const Rendering out = Renderer().render(built.scene, built.view);
  EXPECT_EQ(std::ranges::count(out.labels, kBackground), static_cast<std::ptrdiff_t>(out.labels.size()));
}

TEST(BuildScene, PlacesCamerasByTheirMounting) {
  for (const char* mounting : {"room", "ceiling", "wheelchair"}) {
    const CameraPlacement placement = camera_placement(mounting);
    int placed = 0;
    for (std::uint64_t i = 0; i < 60; ++i) {
      const BuiltScene built = build(3000 + i, 1, placement);
      const Eigen::Isometry3f pose = built.view.camera_from_world.inverse();
      EXPECT_GE(pose.translation().y(), placement.height_min_m - 1e-4F);
      EXPECT_LE(pose.translation().y(), placement.height_max_m + 1e-4F);
      placed += static_cast<int>(built.people.size());
    }
    EXPECT_GE(placed, 50) << mounting;
  }
}

TEST(BuildScene, DarkensPiecesToTheEyeToo) {
  SceneOptions options;
  options.furniture_min = 4;
  options.dark_furniture = 1.F;
  const BuiltScene pale = build_scene(options, {}, kCamera, {plan_of({}, 0)}, Random(9));
  options.dark_to_the_eye = 1.F;
  const BuiltScene dark = build_scene(options, {}, kCamera, {plan_of({}, 0)}, Random(9));
  ASSERT_EQ(pale.scene.meshes.size(), dark.scene.meshes.size());
  int darker = 0;
  for (std::size_t i = 0; i < pale.scene.meshes.size(); ++i) {
    const SceneMesh& before = pale.scene.meshes[i];
    const SceneMesh& after = dark.scene.meshes[i];
    const bool piece = i > 0 && before.person < 0;  // 0 is the room
    for (std::size_t m = 0; m < before.materials.size(); ++m) {
      const Rgb was = before.materials[m].colour, is = after.materials[m].colour;
      if (!piece) {
        EXPECT_EQ(was, is);
        continue;
      }
      EXPECT_LE(is.g, was.g / 4 + 1);
      darker += is.g < was.g ? 1 : 0;
    }
  }
  EXPECT_GT(darker, 0);
}

TEST(BuildScene, DarkensOnlyWholePieces) {
  SceneOptions options;
  options.furniture_min = 4;
  options.dark_furniture = 0.F;
  const BuiltScene pale = build_scene(options, {}, kCamera, {plan_of({}, 0)}, Random(9));
  options.dark_furniture = 1.F;
  const BuiltScene dark = build_scene(options, {}, kCamera, {plan_of({}, 0)}, Random(9));
  ASSERT_EQ(pale.scene.meshes.size(), dark.scene.meshes.size());
  int pieces = 0;
  for (std::size_t i = 0; i < pale.scene.meshes.size(); ++i) {
    const SceneMesh& before = pale.scene.meshes[i];
    const SceneMesh& after = dark.scene.meshes[i];
    EXPECT_EQ(before.vertices, after.vertices);
    const bool piece = i > 0 && before.person < 0;  // 0 is the room
    pieces += piece ? 1 : 0;
    for (std::size_t m = 0; m < before.materials.size(); ++m) {
      EXPECT_EQ(before.materials[m].colour, after.materials[m].colour);
      if (piece) {
        EXPECT_LE(after.materials[m].infrared, 0.1501F * before.materials[m].infrared);
      } else {
        EXPECT_EQ(after.materials[m].infrared, before.materials[m].infrared);
      }
    }
  }
  EXPECT_GE(pieces, 2);
}

TEST(BuildScene, PlacesSomethingLargeCloseWithTheGivenProbability) {
  SceneOptions options;
  options.furniture_max = 0;
  options.occluder_probability = 0.F;
  const auto near_pieces = [&](float probability) {
    int near = 0;
    options.near_probability = probability;
    for (std::uint64_t i = 0; i < 60; ++i) {
      const BuiltScene built = build_scene(options, {}, kCamera, {}, Random(10, i));
      const Vector3f eye = built.view.camera_from_world.inverse().translation();
      for (const OrientedBox& box : built.solids) near += (box.pose.translation() - eye).norm() < 2.5F ? 1 : 0;
    }
    return near;
  };
  EXPECT_EQ(near_pieces(0.F), 0);
  EXPECT_GE(near_pieces(1.F), 40);
}

TEST(BuildScene, NamesInvalidOptions) {
  SceneOptions options;
  options.furniture_min = 5;
  options.furniture_max = 2;
  EXPECT_THAT([&] { build_scene(options, {}, kCamera, {}, Random(1)); },
              ThrowsMessage<UsageError>(HasSubstr("scene.furniture-min is 5, above scene.furniture-max 2")));
  options = {};
  options.frontal_share = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(build_scene(options, {}, kCamera, {}, Random(1)), UsageError);
  EXPECT_THAT([&] { build_scene({}, {}, kCamera, {PersonPlan{}}, Random(1)); },
              ThrowsMessage<Error>(HasSubstr("person 0 of a scene has no body")));
  EXPECT_THROW(build_scene({}, {}, Camera{}, {}, Random(1)), Error);
}

}  // namespace
}  // namespace vesalius::synth
