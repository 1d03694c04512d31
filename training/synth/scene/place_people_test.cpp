#include "synth/scene/place_people.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "synth/scene/occupancy.h"
#include "synth/scene/test_plans.h"

namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;

float deepest_in_solids(const PlacedPerson& person, const std::vector<OrientedBox>& solids) {
  float deepest = 0.F;
  for (const OrientedBox& box : solids) {
    for (const Vector3f& p : person.body.vertices) deepest = std::max(deepest, depth_inside(box, p));
  }
  return deepest;
}

// Labels: statistics
TEST(BuildScene, KeepsPeopleOutOfFurnitureAndWalls) {
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

// Labels: statistics
TEST(BuildScene, PutsTheFeetOfStandingAndKneelingPeopleOnTheFloor) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    Random random(21, i);
    std::vector<PersonPlan> plans = draw_plans(2, random);
    const BuiltScene built = build_scene({}, {}, kCamera, plans, Random(22, i));
    for (const PlacedPerson& person : built.people) {
      const Posture posture = plans[person.plan].posture;
      if (posture == Posture::lying || posture == Posture::sitting) continue;
      float lowest = std::numeric_limits<float>::infinity();
      for (const Vector3f& p : person.body.vertices) lowest = std::min(lowest, p.y());
      ASSERT_NEAR(lowest, 0.F, 1e-4F) << i;
    }
  }
}

// Labels: statistics
TEST(BuildScene, PutsSeatsDirectlyUnderSittingPeople) {
  int sitters = 0, supported = 0;
  for (std::uint64_t i = 0; i < 150; ++i) {
    Random random(31, i);
    const std::vector<PersonPlan> plans = {
        plan_of(sample_pose(only(&PoseSamplerOptions::sitting), random), random.next()),
        plan_of(sample_pose(only(&PoseSamplerOptions::sitting), random), random.next())};
    const BuiltScene built = build_scene({}, {}, kCamera, plans, Random(32, i));
    for (const PlacedPerson& person : built.people) {
      ++sitters;
      // There is a seat just below the lowest skin at the hips.
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

/// Returns whether a ray from the point along x meets the body's surface an odd number of times.
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

// Labels: statistics
TEST(BuildScene, KeepsPeopleApart) {
  float deepest = 0.F;
  int near = 0;
  for (std::uint64_t i = 0; i < 120; ++i) {
    const BuiltScene built = build(1000 + i, 4);
    for (const PlacedPerson& one : built.people) {
      Eigen::AlignedBox3f bounds;
      for (const Vector3f& p : one.body.vertices) bounds.extend(p);
      for (const PlacedPerson& other : built.people) {
        if (&one == &other) continue;
        const auto& triangles = built.scene.meshes[one.mesh].triangles;
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

/// Returns the smallest distance between two people's skins, or infinity if their bounds are far apart.
float apart(const PlacedPerson& one, const PlacedPerson& other) {
  constexpr float kFar_m = 0.3F;
  Eigen::AlignedBox3f bounds;
  for (const Vector3f& p : one.body.vertices) bounds.extend(p);
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k < other.body.vertices.size(); k += 3) {
    const Vector3f& p = other.body.vertices[k];
    if (bounds.squaredExteriorDistance(p) > kFar_m * kFar_m) continue;
    for (const Vector3f& q : one.body.vertices) nearest = std::min(nearest, (p - q).squaredNorm());
  }
  return std::sqrt(nearest);
}

/// Returns the number of scenes with two standing people in which they nearly touch. `sunk` becomes true if two people
/// overlap too much.
int close_pairs(const SceneOptions& options, int scenes, bool& sunk) {
  int close = 0;
  for (int i = 0; i < scenes; ++i) {
    Random random(21, static_cast<std::uint64_t>(i));
    std::vector<PersonPlan> plans;
    while (plans.size() < 2) {
      plans.push_back(plan_of(sample_pose({}, random), random.next()));
      if (plans.back().posture != Posture::standing) plans.pop_back();
    }
    const BuiltScene built = build_scene(options, {}, kCamera, plans, Random(22, static_cast<std::uint64_t>(i)));
    if (built.people.size() < 2 || apart(built.people[0], built.people[1]) > 0.15F) continue;
    ++close;
    const auto outline = [&](const PlacedPerson& person) {
      return outline_of(person.body, plans[person.plan].poser->mesh().stature_m);
    };
    sunk = sunk || sinks_in(outline(built.people[0]), outline(built.people[1]));
  }
  return close;
}

TEST(BuildScene, PlacesPeopleSideBySideWithTheGivenProbability) {
  constexpr int kScenes = 40;
  bool sunk = false;
  const int never = close_pairs({.beside_probability = 0.F}, kScenes, sunk);
  const int sometimes = close_pairs({.beside_probability = 0.5F}, kScenes, sunk);
  const int always = close_pairs({.beside_probability = 1.F}, kScenes, sunk);
  EXPECT_LE(never, kScenes / 8);
  EXPECT_GE(always, kScenes / 2) << "some have their arms in the way, some are cut off by the picture's border";
  EXPECT_GT(sometimes, never);
  EXPECT_LT(sometimes, always);
  EXPECT_FALSE(sunk);
}

TEST(BuildScene, LetsPeopleTouchWithTheGivenProbability) {
  constexpr int kScenes = 40;
  bool pressed = false;
  const int never = close_pairs({}, kScenes, pressed),
            always = close_pairs({.contact_probability = 1.F}, kScenes, pressed);
  EXPECT_LE(never, kScenes / 8);
  EXPECT_GE(always, kScenes / 2);
}

}  // namespace
}  // namespace vesalius::synth
