#include "synth/scene/scene_options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include "synth/scene/occupancy.h"
#include "synth/scene/test_plans.h"
#include "synth/sensor/render.h"

// What the options that are off by default do to whole scenes.
namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;

/// Returns the plan of one person whose pose is of one kind.
std::vector<PersonPlan> plan_of_kind(float PoseSamplerOptions::*kind, std::uint64_t stream) {
  Random random(41, stream);
  const SampledPose pose = sample_pose(only(kind), random);
  return {plan_of(pose, random.next())};
}

SceneOptions bare() {
  SceneOptions options;
  options.open_share = options.occluder_probability = options.near_probability = options.table_probability = 0.F;
  options.furniture_max = 0;
  return options;
}

/// Builds scenes of one person of a kind each.
void for_scenes(int count, const SceneOptions& options, float PoseSamplerOptions::*kind,
                const std::function<void(const BuiltScene&)>& use) {
  for (int i = 0; i < count; ++i) {
    const auto stream = static_cast<std::uint64_t>(i);
    use(build_scene(options, {}, kCamera, plan_of_kind(kind, stream), Random(42, stream)));
  }
}

/// Returns the mean number of pixels of people.
double person_pixels(const SceneOptions& options, float PoseSamplerOptions::*kind) {
  Renderer renderer;
  double sum = 0.0;
  constexpr int kScenes = 30;
  for_scenes(kScenes, options, kind, [&](const BuiltScene& built) {
    const Rendering out = renderer.render(built.scene, built.view, {.colour = false, .projector = {}});
    sum +=
        static_cast<double>(out.labels.size() - static_cast<std::size_t>(std::ranges::count(out.labels, kBackground)));
  });
  return sum / kScenes;
}

TEST(SceneOptions, KeepPeopleOutOfSolidsAndWallsWithAllOn) {
  SceneOptions options;
  options.nobody_share = options.near_nobody_share = 0.5F;
  options.soft_probability = options.blanket_probability = options.lying_sofa_probability = 0.5F;
  options.desk_probability = options.wall_probability = options.border_share = 0.5F;
  options.gear_share = options.care_probability = options.load_probability = 0.5F;
  options.doorway_probability = options.cut_share = options.picture_probability = 0.5F;
  int placed = 0;
  constexpr int kScenes = 120;
  for (std::uint64_t i = 0; i < kScenes; ++i) {
    Random random(43, i);
    const BuiltScene built = build_scene(options, {}, kCamera, draw_plans(2, random), Random(44, i));
    placed += static_cast<int>(built.people.size());
    for (const PlacedPerson& person : built.people) {
      for (const Vector3f& p : person.body.vertices) {
        ASSERT_TRUE(built.room.open || clearance(built.room, {p.x(), 1.F, p.z()}) >= 0.F) << i;
        for (const OrientedBox& box : built.solids) ASSERT_LE(depth_inside(box, p), kMaxSink_m) << i;
      }
    }
  }
  EXPECT_GT(placed, 2 * kScenes * 9 / 10);
}

TEST(SceneOptions, HidePartsOfPeopleInCushions) {
  SceneOptions options = bare();
  const double hard = person_pixels(options, &PoseSamplerOptions::sitting);
  options.soft_probability = 1.F;
  options.soft_depth_m = 0.1F;
  const double soft = person_pixels(options, &PoseSamplerOptions::sitting);
  EXPECT_LT(soft, 0.95 * hard);
  EXPECT_GT(soft, 0.5 * hard) << "people are still to be seen";
}

TEST(SceneOptions, CoverLyingPeopleWithBlankets) {
  SceneOptions options = bare();
  const double bare_pixels = person_pixels(options, &PoseSamplerOptions::lying);
  options.blanket_probability = 1.F;
  const double covered = person_pixels(options, &PoseSamplerOptions::lying);
  EXPECT_LT(covered, 0.6 * bare_pixels);
  EXPECT_GT(covered, 0.05 * bare_pixels);
}

TEST(SceneOptions, PutLyingPeopleOnSofas) {
  SceneOptions options = bare();
  options.bed_probability = 1.F;
  options.lying_sofa_probability = 1.F;
  int sofas = 0, people = 0;
  for_scenes(40, options, &PoseSamplerOptions::lying, [&](const BuiltScene& built) {
    if (built.people.empty()) return;
    ++people;
    // The back of a sofa is a long box that begins at its seat; beds have none.
    sofas += std::ranges::any_of(built.solids,
                                 [](const OrientedBox& box) {
                                   return box.half.x() > 0.7F && box.half.y() > 0.13F && box.half.z() < 0.12F;
                                 })
                 ? 1
                 : 0;
  });
  EXPECT_GE(people, 30);
  EXPECT_GE(sofas, people / 3) << "others are too wide for one";
}

TEST(SceneOptions, CoverPeopleInBedsWithRailsToTheNeck) {
  SceneOptions options = bare();
  options.bed_probability = options.blanket_probability = 1.F;
  const double to_chest = person_pixels(options, &PoseSamplerOptions::lying);
  options.care_probability = 1.F;
  const double to_neck = person_pixels(options, &PoseSamplerOptions::lying);
  EXPECT_LT(to_neck, to_chest);
  EXPECT_GT(to_neck, 0.1 * to_chest);
}

TEST(SceneOptions, LetPeopleSitUpInBeds) {
  SceneOptions options = bare();
  options.bed_probability = 1.F;
  const auto raised = [&] {
    int count = 0;
    for_scenes(40, options, &PoseSamplerOptions::sitting_up, [&](const BuiltScene& built) {
      for (const PlacedPerson& person : built.people) {
        count += person.posture == Posture::sitting && person.body.joints[index(Bone::pelvis)].y() > 0.25F ? 1 : 0;
      }
    });
    return count;
  };
  EXPECT_EQ(raised(), 0) << "without care nobody who sits low has a bed";
  options.care_probability = 1.F;
  EXPECT_GE(raised(), 10);
}

TEST(SceneOptions, SeatPeopleInWheelchairsWithTheirFeetOnTheRests) {
  SceneOptions options = bare();
  options.care_probability = 1.F;
  options.bed_probability = 0.F;
  int people = 0, lifted = 0, held = 0;
  for_scenes(80, options, &PoseSamplerOptions::sitting, [&](const BuiltScene& built) {
    for (const PlacedPerson& person : built.people) {
      ++people;
      Vector3f sole(0.F, std::numeric_limits<float>::infinity(), 0.F);
      for (const Vector3f& p : person.body.vertices) sole = p.y() < sole.y() ? p : sole;
      if (sole.y() < 0.045F) continue;  // on a toilet or bench the feet are on the floor
      ++lifted;
      held += std::ranges::any_of(
                  built.solids,
                  [&](const OrientedBox& box) { return box.half.y() < 0.01F && -depth_inside(box, sole) < 0.02F; })
                  ? 1
                  : 0;
    }
  });
  EXPECT_GE(people, 70);
  EXPECT_GE(lifted, people / 3);
  EXPECT_EQ(held, lifted);
}

TEST(SceneOptions, HidePeopleBehindTheEdgesOfDoorways) {
  SceneOptions options = bare();
  const double whole = person_pixels(options, &PoseSamplerOptions::idle);
  options.doorway_probability = 1.F;
  const double hidden = person_pixels(options, &PoseSamplerOptions::idle);
  EXPECT_LT(hidden, 0.9 * whole);
  EXPECT_GT(hidden, 0.3 * whole);
}

TEST(SceneOptions, CutPeopleAtTheUpperAndLowerBorders) {
  SceneOptions options = bare();
  CameraPlacement upright;
  upright.roll_max_deg = 0.F;
  const auto cut = [&] {
    std::array<int, 2> beyond{};  // above, below
    for (std::uint64_t i = 0; i < 60; ++i) {
      const BuiltScene built = build_scene(options, upright, kCamera, {plan_of({}, 0)}, Random(45, i));
      for (const PlacedPerson& person : built.people) {
        const auto row = [&](const Vector3f& p) { return kCamera.pixel(built.view.camera_from_world * p).y(); };
        beyond[0] += row(person.body.joints[index(Bone::neck)]) < 0.F ? 1 : 0;
        beyond[1] += row(person.body.joints[index(Bone::l_thigh)]) > float(kCamera.height) ? 1 : 0;
      }
    }
    return beyond;
  };
  const std::array<int, 2> usual = cut();
  options.cut_share = 1.F;
  const std::array<int, 2> tilted = cut();
  EXPECT_GE(tilted[0], usual[0] + 8) << "legs without heads";
  EXPECT_GE(tilted[1], usual[1] + 8) << "heads without legs";
}

TEST(SceneOptions, FillRoomsWithGear) {
  SceneOptions options = bare();
  options.furniture_min = options.furniture_max = 4;
  const auto solids = [&] {
    std::size_t sum = 0;
    for_scenes(30, options, &PoseSamplerOptions::idle, [&](const BuiltScene& built) {
      sum += std::ranges::count_if(built.solids, [](const OrientedBox& box) { return box.half.minCoeff() < 0.02F; });
    });
    return sum;
  };
  const std::size_t usual = solids();
  options.gear_share = 1.F;
  EXPECT_GT(solids(), usual + usual / 2) << "it stands on rods";
}

TEST(SceneOptions, HangPicturesAtWallsBehindEverything) {
  SceneOptions options = bare();
  const auto seen = [&] {
    Renderer renderer;
    std::vector<Rendering> result;
    for_scenes(20, options, &PoseSamplerOptions::idle, [&](const BuiltScene& built) {
      result.push_back(renderer.render(built.scene, built.view, {.colour = true, .projector = {}}));
    });
    return result;
  };
  const std::vector<Rendering> plain = seen();
  options.picture_probability = 1.F;
  const std::vector<Rendering> hung = seen();
  int changed = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_TRUE(hung[i].labels == plain[i].labels) << "people in pictures are nobody";
    float nearer_m = 0.F;
    for (std::size_t p = 0; p < plain[i].depth_m.size(); ++p) {
      nearer_m = std::max(nearer_m, plain[i].depth_m.data()[p] - hung[i].depth_m.data()[p]);
    }
    changed += hung[i].colour != plain[i].colour && nearer_m > 0.F ? 1 : 0;
  }
  EXPECT_GE(changed, 14);
}

TEST(SceneOptions, GiveLoadsToThoseWhoHoldTheirHandsBeforeThem) {
  SceneOptions options = bare();
  const auto loaded = [&] {
    int count = 0;
    for_scenes(60, options, &PoseSamplerOptions::carrying,
               [&](const BuiltScene& built) { count += built.solids.empty() ? 0 : 1; });
    return count;
  };
  EXPECT_EQ(loaded(), 0);
  options.load_probability = 1.F;
  EXPECT_GE(loaded(), 20);
}

TEST(SceneOptions, PutCountersBeforeStandingPeople) {
  SceneOptions options = bare();
  options.desk_probability = 1.F;
  int counters = 0, people = 0;
  for_scenes(40, options, &PoseSamplerOptions::idle, [&](const BuiltScene& built) {
    people += static_cast<int>(built.people.size());
    counters += built.solids.empty() ? 0 : 1;
  });
  EXPECT_GE(people, 35);
  EXPECT_GE(counters, people * 3 / 4);
}

TEST(SceneOptions, PutWallsCloseBehindPeople) {
  SceneOptions options = bare();
  const auto near_walls = [&] {
    int near = 0;
    for_scenes(60, options, &PoseSamplerOptions::idle, [&](const BuiltScene& built) {
      if (built.people.empty() || built.room.open) return;
      const Vector3f chest = built.people[0].body.joints[index(Bone::chest)];
      const Vector3f in_room = built.room.world_from_room.inverse() * chest;
      near += in_room.z() - built.room.low.y() < 0.9F ? 1 : 0;  // half a person and the gap
    });
    return near;
  };
  EXPECT_LE(near_walls(), 20);
  options.wall_probability = 1.F;
  EXPECT_GE(near_walls(), 50);
}

TEST(SceneOptions, CutPeopleByTheBorder) {
  SceneOptions options = bare();
  const auto cut = [&] {
    int people = 0;
    for_scenes(80, options, &PoseSamplerOptions::idle, [&](const BuiltScene& built) {
      if (built.people.empty()) return;
      const auto& joints = built.people[0].body.joints;
      people += std::ranges::any_of(joints,
                                    [&](const Vector3f& joint) {
                                      const Vector3f p = built.view.camera_from_world * joint;
                                      const float u = built.view.camera.pixel(p).x();
                                      return p.z() > 0.1F && (u < 0.F || u > static_cast<float>(kCamera.width - 1));
                                    })
                    ? 1
                    : 0;
    });
    return people;
  };
  const int usual = cut();
  options.border_share = 1.F;
  EXPECT_GE(cut(), 60);
  EXPECT_LE(usual, 40);
}

}  // namespace
}  // namespace vesalius::synth
