#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "capsule/capsule_person.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

// No pixel looks straight ahead, since the middle plane lies between pixels.
const Camera kCamera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};

CapsuleScene empty_room() {
  CapsuleScene scene;
  scene.floor_y_m = 0.F;
  scene.wall_z_m = 0.F;
  return scene;
}

CapsuleScene one_person(float yaw = 0.F) {
  CapsuleScene scene;
  CapsulePerson person;
  person.pose.yaw = yaw;
  scene.people.push_back(person);
  return scene;
}

std::set<int> labels_of(const LabelledFrame& frame) { return {frame.labels.begin(), frame.labels.end()}; }

TEST(CapsuleRender, PutsWallAndFloorInTheirPlaces) {
  CapsuleScene scene;
  scene.floor_y_m = 1.F;
  scene.wall_z_m = 4.5F;
  scene.side_wall_x_m = 2.F;
  const LabelledFrame out = render(scene, kCamera, paper_body());
  EXPECT_EQ(out.frame.depth(150, 20), 4500);
  const float floor_z_m = 262.5F / (230.F - 119.5F);
  EXPECT_NEAR(out.frame.depth(150, 230), floor_z_m * 1000.F, 1.F);
  EXPECT_NEAR(out.frame.depth(10, 119), 1000.F * 2.F * 262.5F / 149.5F, 1.F);
  EXPECT_EQ(out.frame.depth(10, 119), out.frame.depth(309, 119));
  EXPECT_EQ(labels_of(out), std::set<int>{kBackground});
}

TEST(CapsuleRender, GivesNoReadingWithoutASurface) {
  const LabelledFrame out = render(empty_room(), kCamera, paper_body());
  EXPECT_THAT(std::vector<int>(out.frame.depth.begin(), out.frame.depth.end()), testing::Each(0));
}

TEST(CapsuleRender, ShowsTheNearSideOfABox) {
  CapsuleScene scene = empty_room();
  scene.boxes.push_back({{-0.5F, -0.5F, 2.F}, {0.5F, 0.5F, 3.F}});
  const LabelledFrame out = render(scene, kCamera, paper_body());
  const int half_width = static_cast<int>(0.5F / 2.F * 262.5F);
  EXPECT_EQ(out.frame.depth(160, 120), 2000);
  EXPECT_EQ(out.frame.depth(160 + half_width - 2, 120), 2000);
  EXPECT_EQ(out.frame.depth(160 + half_width + 2, 120), 0);
}

TEST(CapsuleRender, ShowsTheFloorToAPitchedCamera) {
  CapsuleScene scene = empty_room();
  scene.floor_y_m = 1.F;
  scene.pitch = std::numbers::pi_v<float> / 2.F;  // straight down
  const LabelledFrame out = render(scene, kCamera, paper_body());
  EXPECT_EQ(out.frame.depth(10, 10), 1000);
  EXPECT_EQ(out.frame.depth(300, 200), 1000);
}

// The neck is an upright cylinder whose depth in its own rows is known in closed form.
TEST(CapsuleRender, ShowsTheNeckAsACylinderOfItsRadius) {
  CapsuleScene scene = one_person();
  const double radius_m = 0.034 * 1.75;
  const Eigen::Vector3f neck = scene.people[0].feet - Eigen::Vector3f(0.F, 0.848F * 1.75F, 0.F);
  const Eigen::Vector2f at = kCamera.pixel(neck);
  const int v = static_cast<int>(std::lround(at.y()));
  const LabelledFrame out = render(scene, kCamera, paper_body());
  for (const int u : {157, 159, 160, 162}) {
    // This solves |(x(t), z(t)) - (0, 2.5)| = r for the ray (s t, t).
    const double s = (u - 159.5) / 262.5, a = s * s + 1.0;
    const double z_m = (2.5 - std::sqrt(2.5 * 2.5 - a * (2.5 * 2.5 - radius_m * radius_m))) / a;
    EXPECT_NEAR(out.frame.depth(u, v), z_m * 1000.0, 0.51) << u;
    EXPECT_EQ(out.labels(u, v), paper_body().find_part("neck"));
  }
}

TEST(CapsuleRender, PutsPixelsAroundTheirPartsCentre) {
  for (const float yaw : {0.F, 1.F, 2.F, 4.F}) {
    CapsuleScene scene = one_person(yaw);
    scene.pitch = 0.15F;
    const LabelledFrame out = render(scene, kCamera, paper_body());
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        if (out.labels(u, v) == kBackground) continue;
        const Eigen::Vector3f p = kCamera.point(static_cast<float>(u), static_cast<float>(v),
                                                static_cast<float>(out.frame.depth(u, v)) * 1e-3F);
        ASSERT_LT((p - out.parts[0][out.labels(u, v)]).norm(), 0.32F) << u << " " << v << " yaw " << yaw;
      }
    }
  }
}

TEST(CapsuleRender, ShowsEveryPartFromTheFrontAndFromBehind) {
  const float half_turn = std::numbers::pi_v<float>;
  EXPECT_EQ(labels_of(render(one_person(0.F), kCamera, paper_body())).size(), 26U);
  EXPECT_EQ(labels_of(render(one_person(half_turn), kCamera, paper_body())).size(), 26U);
}

TEST(CapsuleRender, HidesTheFarArmOfAPersonSeenFromTheSide) {
  const std::set<int> seen = labels_of(render(one_person(std::numbers::pi_v<float> / 2.F), kCamera, paper_body()));
  EXPECT_TRUE(seen.contains(paper_body().find_part("r_upper_arm")));
  EXPECT_FALSE(seen.contains(paper_body().find_part("l_upper_arm")));
}

/// Returns a scene with a posed and turned person, and its reflection in the plane x = 0.
std::pair<CapsuleScene, CapsuleScene> scene_and_reflection() {
  CapsuleScene scene, mirrored;
  scene.pitch = mirrored.pitch = 0.1F;
  CapsulePerson person;
  person.feet = {0.35F, 1.F, 2.2F};
  person.pose = {0.6F, 0.2F, 0.1F, 0.3F, 0.2F, {0.5F, 0.9F, 1.1F}, {1.4F, 1.F, 0.4F}, {0.1F, 0.5F, 0.3F}, {0.2F}};
  CapsulePerson other = person;
  other.feet.x() = -0.35F;
  other.pose.yaw = -0.6F;
  other.pose.side_lean = -0.1F;
  other.pose.head_yaw = -0.3F;
  std::swap(other.pose.l_arm, other.pose.r_arm);
  std::swap(other.pose.l_leg, other.pose.r_leg);
  scene.people.push_back(person);
  mirrored.people.push_back(other);
  return {scene, mirrored};
}

TEST(CapsuleRender, ReflectsThePictureAndSwapsSidesForAReflectedScene) {
  const auto [scene, mirrored] = scene_and_reflection();
  const LabelledFrame a = render(scene, kCamera, paper_body());
  const LabelledFrame b = render(mirrored, kCamera, paper_body());
  int body_pixels = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const int w = kCamera.width - 1 - u;
      ASSERT_EQ(a.frame.depth(u, v), b.frame.depth(w, v)) << u << " " << v;
      const int label = a.labels(u, v);
      const int partner = label == kBackground ? kBackground : paper_body().parts[label].mirror;
      ASSERT_EQ(partner, b.labels(w, v)) << u << " " << v;
      body_pixels += label != kBackground;
    }
  }
  EXPECT_GT(body_pixels, 3000);
}

TEST(CapsuleRender, HidesSurfacesBehindOccluders) {
  CapsuleScene scene = one_person();
  scene.people.push_back(scene.people[0]);
  scene.people[1].feet.z() = 3.5F;  // behind the first
  scene.boxes.push_back({{-1.F, 0.4F, 1.5F}, {1.F, 1.F, 1.7F}});
  const LabelledFrame out = render(scene, kCamera, paper_body());
  const std::set<int> seen = labels_of(out);
  EXPECT_FALSE(seen.contains(paper_body().find_part("l_foot")));
  EXPECT_TRUE(seen.contains(paper_body().find_part("l_chest")));
  int second = 0;
  for (std::size_t i = 0; i < out.person.size(); ++i) {
    EXPECT_EQ(out.person[i] == kBackground, out.labels[i] == kBackground);
    second += out.person[i] == 1;
  }
  scene.people.erase(scene.people.begin());
  const LabelledFrame alone = render(scene, kCamera, paper_body());
  EXPECT_LT(second, std::ranges::count(alone.person, 0) / 5) << "only a rim of the person behind shows";
}

TEST(CapsuleRender, PutsClothesAndSkinInTheirPlaces) {
  const LabelledFrame out = render(one_person(), kCamera, paper_body());
  const auto colour_of = [&](const char* part) {
    const Eigen::Vector2f at = kCamera.pixel(out.parts[0][paper_body().find_part(part)]);
    return out.frame.colour(static_cast<int>(at.x()), static_cast<int>(at.y()));
  };
  const Rgb chest = colour_of("l_chest"), face = colour_of("l_face_bottom");
  EXPECT_GT(chest.b, chest.r) << "blue shirt";
  EXPECT_GT(face.r, face.b) << "skin";
}

// Labels: threads
TEST(CapsuleRender, GivesTheSameBytesForAnyNumberOfThreads) {
  const CapsuleScene scene = scene_and_reflection().first;
  std::vector<LabelledFrame> results;
  for_threads({1, 2, 8}, [&] { results.push_back(render(scene, kCamera, paper_body())); });
  for (const LabelledFrame& result : results) {
    EXPECT_EQ(result.frame.depth, results[0].frame.depth);
    EXPECT_EQ(result.frame.colour, results[0].frame.colour);
    EXPECT_EQ(result.labels, results[0].labels);
  }
}

TEST(CapsuleRender, MatchesPartsOfOtherBodiesByName) {
  BodyModel body;
  for (const char* name : {"tail", "neck", "l_chest", "l_upper_arm"}) {
    BodyPart part;
    part.name = name;
    body.parts.push_back(part);
  }
  const LabelledFrame coarse = render(one_person(), kCamera, body);
  const LabelledFrame fine = render(one_person(), kCamera, paper_body());
  const auto expected = [&](int label) -> int {
    if (label == kBackground) return kBackground;
    const std::string name = paper_body().parts[label].name;
    const std::set<std::string> arm = {"l_upper_arm", "l_elbow", "l_forearm", "l_hand"};
    const std::set<std::string> trunk = {"l_chest", "l_hips", "l_thigh", "l_knee", "l_leg", "l_foot"};
    return arm.contains(name) ? 3 : trunk.contains(name) ? 2 : 1;
  };
  for (std::size_t i = 0; i < fine.labels.size(); ++i) ASSERT_EQ(coarse.labels[i], expected(fine.labels[i]));
  ASSERT_EQ(coarse.parts[0].size(), 4U);
  EXPECT_TRUE(std::isnan(coarse.parts[0][0].x()));
  EXPECT_TRUE(coarse.parts[0][3].allFinite());
}

TEST(CapsuleRender, RendersAPersonAsCloseAsTheLens) {
  CapsuleScene scene = one_person();
  scene.people[0].feet = {0.F, 1.F, 0.05F};  // the camera is inside the chest
  EXPECT_NO_THROW(render(scene, kCamera, paper_body()));
}

TEST(CapsuleRender, RefusesImpossibleScenes) {
  EXPECT_THROW(render({}, Camera{}, paper_body()), Error);
  CapsuleScene scene;
  scene.pitch = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(render(scene, kCamera, paper_body()), Error);
  scene = {};
  scene.boxes.push_back({{1.F, 0.F, 0.F}, {0.F, 1.F, 1.F}});
  EXPECT_THROW(render(scene, kCamera, paper_body()), Error);
  scene = {};
  scene.people.resize(256);
  EXPECT_THROW(render(scene, kCamera, paper_body()), Error);
}

}  // namespace
}  // namespace vesalius
