#include "synth/build_scene.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "synth/builtin_body.h"
#include "synth/occupancy.h"
#include "synth/pose_sampler.h"
#include "synth/render.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr Camera kCamera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};

const std::vector<std::unique_ptr<Poser>>& posers() {
  static const std::vector<std::unique_ptr<Poser>> kPosers = [] {
    std::vector<std::unique_ptr<Poser>> made;
    Random random(3);
    for (int i = 0; i < 4; ++i) {
      made.push_back(std::make_unique<Poser>(
          std::make_shared<const BodyMesh>(make_builtin_body(sample_builtin_shape(random), paper_body())),
          paper_body()));
    }
    return made;
  }();
  return kPosers;
}

PersonPlan plan_of(const SampledPose& sampled, std::uint32_t body) {
  PersonPlan plan;
  plan.poser = posers()[body % posers().size()].get();
  plan.pose = sampled.pose;
  plan.posture = sampled.posture;
  return plan;
}

std::vector<PersonPlan> draw_plans(int count, Random& random) {
  std::vector<PersonPlan> plans;
  for (int i = 0; i < count; ++i) plans.push_back(plan_of(sample_pose({}, random), random.next()));
  return plans;
}

BuiltScene build(std::uint64_t stream, int people, const CameraPlacement& placement = {}) {
  Random random(11, stream);
  return build_scene({}, placement, kCamera, draw_plans(people, random), {}, Random(12, stream));
}

float deepest_in_solids(const PlacedPerson& person, const std::vector<OrientedBox>& solids) {
  float deepest = 0.F;
  for (const OrientedBox& box : solids) {
    for (const Vector3f& p : person.body.vertices) deepest = std::max(deepest, depth_inside(box, p));
  }
  return deepest;
}

TEST(BuildScene, NobodyIsInsideFurnitureOrWalls) {
  constexpr int kScenes = 1000;
  int planned = 0, placed = 0, beyond = 0;
  float deepest = 0.F, through_wall = 0.F, off_floor = 0.F;
  for (int i = 0; i < kScenes; ++i) {
    const int people = i % 5;
    const BuiltScene built = build(static_cast<std::uint64_t>(i), people);
    planned += people;
    placed += static_cast<int>(built.people.size());
    ASSERT_GT(clearance(built.room, built.view.camera_from_world.inverse().translation()), 0.05F) << i;
    for (const PlacedPerson& person : built.people) {
      const float depth = deepest_in_solids(person, built.solids);
      deepest = std::max(deepest, depth);
      beyond += depth > kMaxSink_m ? 1 : 0;
      float lowest = std::numeric_limits<float>::infinity();
      for (const Vector3f& p : person.body.vertices) {
        ASSERT_TRUE(p.allFinite());
        lowest = std::min(lowest, p.y());
        const float above_floor = built.room.open ? 0.F : clearance(built.room, {p.x(), 1.F, p.z()});
        through_wall = std::min(through_wall, above_floor);
      }
      off_floor = std::min(off_floor, lowest);
    }
  }
  std::printf("placed %d of %d people; deepest in furniture %.1f mm, %d beyond %.0f mm; below floor %.1f mm\n", placed,
              planned, deepest * 1e3, beyond, kMaxSink_m * 1e3, -off_floor * 1e3);
  EXPECT_GT(placed, planned * 95 / 100);
  EXPECT_EQ(through_wall, 0.F);
  EXPECT_EQ(beyond, 0);
  EXPECT_GT(off_floor, -0.02F);
}

TEST(BuildScene, FeetAreOnTheFloorOfThoseWhoStandAndKneel) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    Random random(21, i);
    std::vector<PersonPlan> plans = draw_plans(2, random);
    const BuiltScene built = build_scene({}, {}, kCamera, plans, {}, Random(22, i));
    for (const PlacedPerson& person : built.people) {
      const Posture posture = plans[static_cast<std::size_t>(person.plan)].posture;
      if (posture == Posture::lying || posture == Posture::sitting) continue;
      float lowest = std::numeric_limits<float>::infinity();
      for (const Vector3f& p : person.body.vertices) lowest = std::min(lowest, p.y());
      ASSERT_NEAR(lowest, 0.F, 1e-4F) << i;
    }
  }
}

PoseSamplerOptions only_sitting() {
  PoseSamplerOptions options;
  for (float* weight :
       {&options.idle, &options.walking, &options.reaching, &options.waving, &options.bending, &options.arms_crossed,
        &options.arms_behind, &options.hands_on_hips, &options.carrying, &options.phone, &options.floor_sitting,
        &options.lying, &options.kneeling, &options.squatting, &options.any}) {
    *weight = 0.F;
  }
  return options;
}

TEST(BuildScene, SeatsAreRightUnderThoseWhoSit) {
  int sitters = 0, supported = 0;
  for (std::uint64_t i = 0; i < 150; ++i) {
    Random random(31, i);
    const std::vector<PersonPlan> plans = {plan_of(sample_pose(only_sitting(), random), random.next()),
                                           plan_of(sample_pose(only_sitting(), random), random.next())};
    const BuiltScene built = build_scene({}, {}, kCamera, plans, {}, Random(32, i));
    for (const PlacedPerson& person : built.people) {
      ++sitters;
      // Just below the lowest skin by the hips there is a seat.
      const Vector3f hips =
          0.5F * (person.body.joints[index(Bone::l_thigh)] + person.body.joints[index(Bone::r_thigh)]);
      float lowest = hips.y();
      for (const Vector3f& p : person.body.vertices) {
        if (std::hypot(p.x() - hips.x(), p.z() - hips.z()) < 0.12F) lowest = std::min(lowest, p.y());
      }
      const bool held = std::ranges::any_of(built.solids, [&](const OrientedBox& box) {
        return depth_inside(box, {hips.x(), lowest - 0.035F, hips.z()}) > 0.F;
      });
      supported += held || lowest < 0.16F ? 1 : 0;
    }
  }
  std::printf("%d of %d sitting people are held by a seat or the floor\n", supported, sitters);
  EXPECT_GT(sitters, 250);
  EXPECT_GE(supported, sitters * 95 / 100);
}

/// Whether a ray from the point along x meets the body's surface an odd number of times.
bool is_inside(const Vector3f& p, const PosedBody& body, const std::vector<Triangle>& triangles) {
  bool inside = false;
  for (const Triangle& t : triangles) {
    const Vector3f a = body.vertices[t[0]] - p, b = body.vertices[t[1]] - p, c = body.vertices[t[2]] - p;
    const auto side = [](const Vector3f& m, const Vector3f& n) { return m.y() * n.z() - m.z() * n.y() > 0.F; };
    if (side(a, b) != side(b, c) || side(b, c) != side(c, a)) continue;
    const Vector3f normal = (b - a).cross(c - a);
    if (normal.dot(a) * normal.x() > 0.F) inside = !inside;
  }
  return inside;
}

TEST(BuildScene, PeopleKeepApart) {
  float deepest = 0.F;
  int near = 0;
  for (std::uint64_t i = 0; i < 120; ++i) {
    const BuiltScene built = build(1000 + i, 4);
    for (const PlacedPerson& one : built.people) {
      Eigen::AlignedBox3f bounds;
      for (const Vector3f& p : one.body.vertices) bounds.extend(p);
      for (const PlacedPerson& other : built.people) {
        if (&one == &other) continue;
        const auto& triangles = built.scene.meshes[static_cast<std::size_t>(one.mesh)].triangles;
        for (std::size_t k = 0; k < other.body.vertices.size(); k += 7) {
          const Vector3f& p = other.body.vertices[k];
          if (!bounds.contains(p)) continue;
          ++near;
          float to_skin = std::numeric_limits<float>::infinity();
          for (const Vector3f& q : one.body.vertices) to_skin = std::min(to_skin, (p - q).squaredNorm());
          if (std::sqrt(to_skin) <= deepest || !is_inside(p, one.body, triangles)) continue;
          deepest = std::sqrt(to_skin);
        }
      }
    }
  }
  std::printf("deepest in another person %.1f mm; %d points looked at\n", deepest * 1e3, near);
  EXPECT_GT(near, 1000);
  EXPECT_LT(deepest, kMaxSink_m);
}

TEST(BuildScene, PeopleAreInThePictureWithTheirOwnNumber) {
  Renderer renderer;
  int seen = 0, all = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const BuiltScene built = build(2000 + i, 2);
    const Rendering out = renderer.render(built.scene, built.view);
    for (std::size_t k = 0; k < built.people.size(); ++k) {
      ++all;
      EXPECT_EQ(built.scene.meshes[static_cast<std::size_t>(built.people[k].mesh)].person, static_cast<int>(k));
      seen += std::ranges::count(out.person, static_cast<std::uint8_t>(k)) > 30 ? 1 : 0;
    }
  }
  EXPECT_GE(seen, all * 9 / 10);
}

TEST(BuildScene, WhoFacesTheCameraHasTheLeftHandOnTheRightOfThePicture) {
  SceneOptions options;
  options.furniture_max = 0;
  options.occluder_probability = 0.F;
  options.min_visible = 0.9F;
  CameraPlacement upright;
  upright.roll_max_deg = 0.F;
  PersonPlan plan = plan_of({}, 0);
  for (const float yaw : {0.F, 3.14159F}) {
    plan.yaw_rad = yaw;
    const BuiltScene built = build_scene(options, upright, kCamera, {plan}, {}, Random(5));
    ASSERT_EQ(built.people.size(), 1U);
    const auto column = [&](Bone bone) {
      return kCamera.pixel(built.view.camera_from_world * built.people[0].body.joints[index(bone)]).x();
    };
    EXPECT_EQ(column(Bone::l_hand) > column(Bone::r_hand), yaw == 0.F);
    EXPECT_LT(kCamera.pixel(built.view.camera_from_world * built.people[0].body.ends[index(Bone::head)]).y(),
              kCamera.pixel(built.view.camera_from_world * built.people[0].body.ends[index(Bone::l_foot)]).y());
  }
}

TEST(BuildScene, HeadingsFollowTheFrontalShare) {
  int frontal = 0, all = 0;
  SceneOptions options;
  options.furniture_max = 0;
  for (std::uint64_t i = 0; i < 800; ++i) {
    const BuiltScene built = build_scene(options, {}, kCamera, {plan_of({}, 0)}, {}, Random(6, i));
    for (const PlacedPerson& person : built.people) {
      Vector3f to_camera = -person.world_from_body.translation();
      to_camera.y() = 0.F;
      const float cosine = to_camera.normalized().dot(person.world_from_body.linear().col(2));
      frontal += cosine > 0.5F ? 1 : 0;
      ++all;
    }
  }
  // 45 % on purpose and a third of the others by chance; five standard deviations either way
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

TEST(BuildScene, SameSeedSameSceneOtherSeedAnother) {
  EXPECT_TRUE(same(build(7, 3), build(7, 3)));
  EXPECT_FALSE(same(build(7, 3), build(8, 3)));
}

TEST(BuildScene, EmptyRoomsHaveNobody) {
  const BuiltScene built = build(9, 0);
  EXPECT_TRUE(built.people.empty());
  EXPECT_GE(built.scene.meshes.size(), 1U);
  const Rendering out = Renderer().render(built.scene, built.view);
  EXPECT_EQ(std::ranges::count(out.labels, kBackground), static_cast<std::ptrdiff_t>(out.labels.size()));
}

TEST(BuildScene, CamerasStandAsMounted) {
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

TEST(BuildScene, UsesTheModelsGiven) {
  SceneMesh model;
  model.vertices = {{-0.2F, 0.F, -0.2F}, {0.2F, 0.F, -0.2F}, {0.2F, 0.F, 0.2F}, {0.F, 0.5F, 0.F}};
  model.triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  SceneOptions options;
  options.furniture_min = options.furniture_max = 10;
  int found = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const BuiltScene built = build_scene(options, {}, kCamera, {}, {model}, Random(8, i));
    for (const SceneMesh& mesh : built.scene.meshes) found += mesh.vertices.size() == 4 ? 1 : 0;
  }
  EXPECT_GT(found, 10);
}

TEST(BuildScene, SaysWhatCannotBeMeant) {
  SceneOptions options;
  options.furniture_min = 5;
  options.furniture_max = 2;
  EXPECT_THAT([&] { build_scene(options, {}, kCamera, {}, {}, Random(1)); },
              ThrowsMessage<UsageError>(HasSubstr("scene.furniture-min is 5, above scene.furniture-max 2")));
  options = {};
  options.frontal_share = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(build_scene(options, {}, kCamera, {}, {}, Random(1)), UsageError);
  EXPECT_THAT([&] { build_scene({}, {}, kCamera, {PersonPlan{}}, {}, Random(1)); },
              ThrowsMessage<Error>(HasSubstr("person 0 of a scene has no body")));
  EXPECT_THROW(build_scene({}, {}, Camera{}, {}, {}, Random(1)), Error);
}

}  // namespace
}  // namespace vesalius::synth
