#include "vesalius/planes/find_planes.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capsule/capsule_person.h"
#include "vesalius/base/test_threads.h"

namespace vesalius {
namespace {

const Camera kCamera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};

TEST(FindPlanes, FindsFloorAndWallOfARoom) {
  CapsuleScene scene;
  scene.floor_y_m = 1.1F;
  scene.wall_z_m = 3.5F;
  const LabelledFrame room = render(scene, kCamera, paper_body());
  const std::vector<Plane> planes = find_planes(room.frame.depth, kCamera, {});
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_GE(planes[0].area_m2, planes[1].area_m2);
  const Plane& wall = std::abs(planes[0].normal.z()) > 0.9F ? planes[0] : planes[1];
  const Plane& floor = &wall == planes.data() ? planes[1] : planes[0];
  EXPECT_NEAR(wall.normal.z(), 1.F, 1e-3);
  EXPECT_NEAR(wall.offset, 3.5F, 0.01F);
  EXPECT_NEAR(floor.normal.y(), 1.F, 1e-3);
  EXPECT_NEAR(floor.offset, 1.1F, 0.01F);
  // Visible wall: from the floor to the picture's upper edge, all of its width.
  const float height = 1.1F + 119.5F / 262.5F * 3.5F, width = 320.F / 262.5F * 3.5F;
  EXPECT_NEAR(wall.area_m2, height * width, 0.15F * height * width);
}

TEST(FindPlanes, NoneOnAPersonAloneOrInAnEmptyPicture) {
  CapsuleScene scene;
  scene.people.emplace_back();
  scene.floor_y_m = 0.F;
  scene.wall_z_m = 0.F;
  EXPECT_TRUE(find_planes(render(scene, kCamera, paper_body()).frame.depth, kCamera, {}).empty());
  EXPECT_TRUE(find_planes(DepthImage(320, 240, 0), kCamera, {}).empty());
}

TEST(FindPlanes, OneSearchGivesPlanesAndTheirPixels) {
  CapsuleScene scene;
  scene.people.emplace_back();
  const LabelledFrame room = render(scene, kCamera, paper_body());
  const FlatSurfaces both = find_flat_surfaces(room.frame.depth, kCamera, {});
  const std::vector<Plane> planes = find_planes(room.frame.depth, kCamera, {});
  EXPECT_EQ(both.pixels, flat_pixels(room.frame.depth, kCamera, {}));
  EXPECT_EQ(pixels_on(both.planes, room.frame.depth, kCamera, {}), both.pixels) << "of known planes the same";
  ASSERT_EQ(both.planes.size(), planes.size());
  ASSERT_FALSE(planes.empty());
  for (std::size_t i = 0; i < planes.size(); ++i) {
    EXPECT_EQ(both.planes[i].normal, planes[i].normal);
    EXPECT_EQ(both.planes[i].offset, planes[i].offset);
  }
}

TEST(FlatPixels, CoverTheRoomAndSpareThePerson) {
  CapsuleScene scene;
  scene.people.emplace_back();
  LabelledFrame truth = render(scene, kCamera, paper_body());
  add_sensor_noise(truth.frame, 5);
  const Mask flat = flat_pixels(truth.frame.depth, kCamera, {});
  long room = 0, room_flat = 0, person = 0, person_flat = 0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    if (truth.frame.depth[i] == 0) continue;
    (truth.person[i] == kBackground ? room : person) += 1;
    if (flat[i] != 0) (truth.person[i] == kBackground ? room_flat : person_flat) += 1;
  }
  EXPECT_GT(room_flat, 0.93 * static_cast<double>(room));
  EXPECT_LT(person_flat, 0.03 * static_cast<double>(person));  // the soles on the floor
}

TEST(FlatPixels, APlaneThatRunsOnThroughAPersonLeavesThemAlone) {
  CapsuleScene scene;
  scene.people.emplace_back();
  scene.people[0].feet = {0.F, 1.F, 2.5F};
  scene.wall_z_m = 0.F;
  // A wall beside the person, in the plane of their front.
  scene.boxes.push_back({{0.5F, -2.F, 2.42F}, {3.F, 1.F, 2.6F}, {200, 200, 200}});
  const LabelledFrame truth = render(scene, kCamera, paper_body());
  const Mask flat = flat_pixels(truth.frame.depth, kCamera, {});
  long person = 0, person_flat = 0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    if (truth.person[i] == kBackground) continue;
    ++person;
    person_flat += flat[i];
  }
  EXPECT_LT(person_flat, 0.05 * static_cast<double>(person));
}

TEST(FlatPixels, FloorBetweenTheFeetIsFloor) {
  CapsuleScene scene;
  scene.people.emplace_back();
  scene.people[0].feet = {0.F, 1.2F, 2.F};
  scene.people[0].pose.l_leg.spread = 0.2F;
  scene.people[0].pose.r_leg.spread = 0.2F;
  scene.floor_y_m = 1.2F;
  scene.pitch = 0.25F;
  LabelledFrame truth = render(scene, kCamera, paper_body());
  add_sensor_noise(truth.frame, 1);
  const Mask flat = flat_pixels(truth.frame.depth, kCamera, {});
  // Rows in which the picture shows person, floor and person again.
  long between = 0, between_flat = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    int first = kCamera.width, last = -1;
    for (int u = 0; u < kCamera.width; ++u) {
      if (truth.person(u, v) == kBackground) continue;
      first = std::min(first, u);
      last = u;
    }
    for (int u = first; u < last; ++u) {
      const float z = static_cast<float>(truth.frame.depth(u, v)) * 1e-3F;
      if (truth.person(u, v) != kBackground || z <= 0.F || z > 2.6F || v < kCamera.height / 2) continue;
      ++between;
      between_flat += flat(u, v);
    }
  }
  ASSERT_GT(between, 300);
  EXPECT_GT(between_flat, 0.85 * static_cast<double>(between));
}

// Labels: threads
TEST(FlatPixels, SameBytesForAnyThreadCount) {
  CapsuleScene scene;
  scene.people.emplace_back();
  const DepthImage depth = render(scene, kCamera, paper_body()).frame.depth;
  std::vector<Mask> results;
  for_threads({1, 2, 8}, [&] { results.push_back(flat_pixels(depth, kCamera, {})); });
  EXPECT_THAT(results, testing::Each(results[0]));
}

Plane plane(const Eigen::Vector3f& normal, float offset) { return {normal.normalized(), offset, 2.F}; }

const Plane kWall = plane({0.F, 0.F, 1.F}, 4.F);
const Plane kCeiling = plane({0.F, -1.F, 0.1F}, 1.2F);
const Plane kTable = plane({0.F, 1.F, 0.2F}, 0.7F);
const Plane kFloor = plane({0.F, 1.F, 0.2F}, 1.4F);

TEST(FindFloor, IsTheLowestLevelPlane) {
  EXPECT_FLOAT_EQ(find_floor({kWall, kCeiling, kTable, kFloor}, std::nullopt)->offset, 1.4F);
  EXPECT_EQ(find_floor({kWall, kCeiling}, std::nullopt), std::nullopt);
  EXPECT_EQ(find_floor({}, std::nullopt), std::nullopt);
}

TEST(FindFloor, FollowsWhatIsKnownOfUp) {
  // A camera on its side: the ground is to the right.
  const Plane right = plane({1.F, 0.F, 0.F}, 1.F);
  EXPECT_EQ(find_floor({right}, std::nullopt), std::nullopt);
  EXPECT_EQ(find_floor({right, kFloor}, std::nullopt, {-1.F, 0.F, 0.F})->offset, 1.F) << "as somebody says";
  EXPECT_FLOAT_EQ(find_floor({right, kFloor}, Eigen::Vector3f(-1.F, 0.F, 0.F))->offset, 1.F);
}

TEST(FindFloor, IsNoSurfaceOnWhichTheCameraLies) {
  EXPECT_EQ(find_floor({plane({0.F, 1.F, 0.F}, 0.02F)}, std::nullopt), std::nullopt);
}

}  // namespace

}  // namespace vesalius
