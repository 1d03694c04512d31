#include "synth/generate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "synth/body/poser.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius::synth {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Returns a recipe with small pictures and few bodies, so that tests are fast.
Recipe small_recipe() {
  Recipe recipe;
  recipe.sensor.width = 160;
  recipe.sensor.height = 120;
  recipe.body.kind = "builtin";
  recipe.body.count = 4;
  return recipe;
}

void expect_same(const LabelledFrame& a, const LabelledFrame& b) {
  EXPECT_EQ(a.frame.name, b.frame.name);
  EXPECT_EQ(a.frame.depth, b.frame.depth);
  EXPECT_EQ(a.frame.colour, b.frame.colour);
  EXPECT_EQ(a.labels, b.labels);
  EXPECT_EQ(a.person, b.person);
  EXPECT_EQ(a.joints, b.joints);
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (std::size_t p = 0; p < a.parts.size(); ++p) EXPECT_EQ(a.parts[p], b.parts[p]);
}

std::vector<LabelledFrame> frames_of(const Generator& generator, std::uint64_t first, int count) {
  std::vector<LabelledFrame> all(static_cast<std::size_t>(count));
  parallel_for(count, [&](int i) { all[i] = generator.frame(first + static_cast<std::uint64_t>(i)); });
  return all;
}

TEST(Generate, CutsPeopleOutOfTheirSurroundings) {
  Recipe recipe = small_recipe();
  const Generator whole(recipe, {}, paper_body(), 7);
  recipe.people.cut_out = 1.F;
  const Generator cut(recipe, {}, paper_body(), 7);
  long person_pixels = 0;
  for (std::uint64_t i = 0; i < 12; ++i) {
    const LabelledFrame a = whole.frame(i);
    const LabelledFrame b = cut.frame(i);
    EXPECT_EQ(a.labels, b.labels);
    EXPECT_EQ(a.joints, b.joints);
    for (std::size_t k = 0; k < a.labels.size(); ++k) {
      const bool person = a.labels[k] != kBackground;
      person_pixels += person ? 1 : 0;
      ASSERT_EQ(b.frame.depth[k], person || a.parts.empty() ? a.frame.depth[k] : 0);
    }
  }
  EXPECT_GT(person_pixels, 1000);
}

TEST(Generate, FiltersTheGivenShareOfPictures) {
  Recipe recipe = small_recipe();
  const Generator plain(recipe, {}, paper_body(), 7);
  recipe.sensor.filter.share = 0.5F;
  recipe.sensor.filter.fill_share = 1.F;
  const Generator filtered(recipe, {}, paper_body(), 7);
  int changed = 0;
  for (std::uint64_t i = 0; i < 24; ++i) {
    const DepthImage before = plain.frame(i).frame.depth, after = filtered.frame(i).frame.depth;
    if (before == after) continue;
    ++changed;
    EXPECT_LT(std::ranges::count(after, 0), std::ranges::count(before, 0));
  }
  EXPECT_GE(changed, 6);
  EXPECT_LE(changed, 18);
}

TEST(Generate, SeesPointsOfTheTruthWhereAWrongFocalLengthHasThem) {
  Recipe recipe = small_recipe();
  recipe.sensor.noise = false;
  recipe.sensor.variety.focal_error = 0.2F;
  const Generator wrong(recipe, {}, paper_body(), 7);
  int seen = 0, own = 0;
  for (std::uint64_t i = 0; i < 24; ++i) {
    const LabelledFrame frame = wrong.frame(i);
    const Camera& camera = frame.frame.camera;
    EXPECT_EQ(camera, sensor_of(recipe.sensor).camera);
    for (const std::vector<Eigen::Vector3f>& parts : frame.parts) {
      for (std::size_t part = 0; part < parts.size(); ++part) {
        const Eigen::Vector3f& p = parts[part];
        if (p.z() <= 0.F) continue;
        const Eigen::Vector2f pixel = camera.pixel(p);
        const int u = int(std::lround(pixel.x())), v = int(std::lround(pixel.y()));
        if (!frame.labels.contains(u, v)) continue;
        ++seen;
        own += frame.labels(u, v) == part ? 1 : 0;
      }
    }
  }
  EXPECT_GT(seen, 300);
  EXPECT_GT(own, seen / 2) << own << " of " << seen;
}

TEST(Generate, MakesStereoErrorsLargerUpToTheGivenFactor) {
  Recipe recipe = small_recipe();
  recipe.sensor.preset = "d435";
  recipe.sensor.height = 80;
  const auto errors_mm = [&](float matching_max) {
    recipe.sensor.variety.matching_max = matching_max;
    const Generator noisy(recipe, {}, paper_body(), 7);
    std::vector<double> mean;
    for (std::uint64_t i = 0; i < 8; ++i) {
      double sum = 0.0, pixels = 0.0;
      const DepthImage depth = noisy.frame(i).frame.depth;
      for (int v = 0; v < depth.height(); ++v) {
        for (int u = 2; u < depth.width(); ++u) {
          if (depth(u, v) == 0 || depth(u - 1, v) == 0) continue;
          sum += std::min(200, std::abs(depth(u, v) - depth(u - 1, v)));
          pixels += 1.0;
        }
      }
      mean.push_back(sum / pixels);
    }
    return mean;
  };
  const std::vector<double> usual = errors_mm(1.F), larger = errors_mm(8.F);
  double most = 0.0, least = 100.0;
  for (std::size_t i = 0; i < usual.size(); ++i) {
    EXPECT_GE(larger[i], 0.95 * usual[i]);
    most = std::max(most, larger[i] / usual[i]);
    least = std::min(least, larger[i] / usual[i]);
  }
  EXPECT_GT(most, 2.0);
  EXPECT_LT(least, 1.6);
}

// Labels: threads
TEST(GenerateThreads, GiveTheSameFramesForAnyNumber) {
  const Generator generator(small_recipe(), {}, paper_body(), 7);
  const std::vector<LabelledFrame> all = frames_of(generator, 0, 24);
  ASSERT_EQ(all.size(), 24U);
  for (const int threads : {1, 8}) {
    const ThreadLimit limit(threads);
    const Generator again(small_recipe(), {}, paper_body(), 7);
    const std::vector<LabelledFrame> others = frames_of(again, 0, 24);
    ASSERT_EQ(others.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) expect_same(all[i], others[i]);
  }
}

TEST(Generate, MakesAnyFrameAlone) {
  const Generator generator(small_recipe(), {}, paper_body(), 7);
  const LabelledFrame in_a_row = frames_of(generator, 10, 6).back();
  const Generator other(small_recipe(), {}, paper_body(), 7);
  expect_same(other.frame(15), in_a_row);
}

TEST(Generate, MakesOtherFramesForOtherSeeds) {
  const Generator a(small_recipe(), {}, paper_body(), 1), b(small_recipe(), {}, paper_body(), 2);
  EXPECT_NE(a.frame(0).frame.depth, b.frame(0).frame.depth);
  EXPECT_NE(a.frame(0).frame.depth, a.frame(1).frame.depth);
}

TEST(Generate, PutsJointsBehindTheirPersonsSurface) {
  Recipe recipe = small_recipe();
  recipe.people = {.none = 0.F, .one = 1.F, .two = 1.F, .three = 0.F, .four = 0.F};
  recipe.sensor.noise = false;
  const Generator generator(recipe, {}, paper_body(), 5);
  int seen = 0;
  for (std::uint64_t i = 0; i < 12; ++i) {
    const LabelledFrame labelled = generator.frame(i);
    ASSERT_EQ(labelled.joints.size(), labelled.parts.size());
    for (std::size_t person = 0; person < labelled.joints.size(); ++person) {
      ASSERT_EQ(labelled.joints[person].size(), joint_names().size());
      for (std::size_t j = 0; j < joint_names().size(); ++j) {
        const Eigen::Vector3f& p = labelled.joints[person][j];
        if (p.z() < 0.2F || joint_names()[j].ends_with("hand_end")) continue;  // closed hands end before it
        const Eigen::Vector2f pixel = labelled.frame.camera.pixel(p);
        const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
        if (!labelled.person.contains(u, v) || labelled.person(u, v) != person) continue;
        const float surface_m = 1e-3F * static_cast<float>(labelled.frame.depth(u, v));
        // Free ends lie on the outline, where the pixel may see what is behind them.
        const float tolerance_m = joint_names()[j].ends_with("_end") ? 0.1F : 0.03F;
        EXPECT_GT(p.z(), surface_m - tolerance_m) << "frame " << i << ", " << joint_names()[j];
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 150);
}

TEST(Generate, KnowsPosturesAndTheUpwardDirection) {
  Recipe recipe = small_recipe();
  recipe.people = {.none = 0.F, .one = 1.F, .two = 1.F, .three = 0.F, .four = 0.F};
  recipe.camera.roll_max_deg = 0.F;
  const Generator generator(recipe, {}, paper_body(), 5);
  for (std::uint64_t i = 0; i < 4; ++i) {
    const LabelledFrame labelled = generator.frame(i);
    ASSERT_EQ(labelled.postures.size(), labelled.parts.size());
    ASSERT_TRUE(labelled.up);
    EXPECT_NEAR(labelled.up->norm(), 1.F, 1e-5F);
    EXPECT_NEAR(labelled.up->x(), 0.F, 1e-5F);  // the camera is not rolled
    EXPECT_LT(labelled.up->y(), 0.F);
    for (std::size_t person = 0; person < labelled.joints.size(); ++person) {
      if (labelled.postures[person] != "standing") continue;
      const Eigen::Vector3f upwards =
          labelled.joints[person][index(Bone::head)] - labelled.joints[person][index(Bone::l_foot)];
      EXPECT_GT(upwards.dot(*labelled.up), 0.3F);
    }
  }
}

TEST(Generate, ChangesLittleWithCoarserSurfaces) {
  Recipe recipe = small_recipe();
  recipe.sensor.noise = false;
  recipe.sensor.colour = false;
  recipe.people = {.none = 0.F, .one = 1.F, .two = 0.F, .three = 0.F, .four = 0.F};
  ASSERT_GT(recipe.scene.detail_px, 0.F);
  const Generator coarse(recipe, {}, paper_body(), 9);
  recipe.scene.detail_px = 0.F;
  const Generator full(recipe, {}, paper_body(), 9);
  std::size_t of_people = 0, relabelled = 0, moved = 0, fewer = 0;
  for (std::uint64_t i = 0; i < 12; ++i) {
    fewer += coarse.scene(i).scene.meshes[1].triangles.size() < full.scene(i).scene.meshes[1].triangles.size() ? 1 : 0;
    const LabelledFrame a = coarse.frame(i), b = full.frame(i);
    EXPECT_EQ(a.joints, b.joints);
    for (std::size_t k = 0; k < a.labels.size(); ++k) {
      if (b.labels[k] == kBackground) continue;
      ++of_people;
      relabelled += a.labels[k] != b.labels[k] ? 1 : 0;
      moved += std::abs(a.frame.depth[k] - b.frame.depth[k]) > 10 ? 1 : 0;
    }
  }
  EXPECT_GE(fewer, 8U);
  EXPECT_LT(relabelled, of_people * 4 / 100);
  EXPECT_LT(moved, of_people * 4 / 100);
}

TEST(Generate, HasTruthOnlyWhereThereIsDepth) {
  Recipe recipe = small_recipe();
  recipe.people = {.none = 0.F, .one = 1.F, .two = 1.F, .three = 0.F, .four = 0.F};
  recipe.sensor.noise = false;
  const Generator generator(recipe, {}, paper_body(), 5);
  int seen_parts = 0, near_parts = 0;
  std::set<int> labels;
  for (const LabelledFrame& labelled : frames_of(generator, 0, 40)) {
    const Frame& frame = labelled.frame;
    for (std::size_t i = 0; i < labelled.labels.size(); ++i) {
      if (labelled.labels[i] == kBackground) continue;
      labels.insert(labelled.labels[i]);
      ASSERT_LT(labelled.person[i], labelled.parts.size()) << "a labelled pixel is somebody's";
      const auto u = static_cast<int>(i % frame.depth.width()), v = static_cast<int>(i / frame.depth.width());
      const Eigen::Vector3f& part = labelled.parts[labelled.person[i]][labelled.labels[i]];
      ++seen_parts;
      near_parts += (point_at(frame.camera, frame.depth, u, v) - part).norm() < 0.35F;
    }
  }
  EXPECT_GT(near_parts, 0.97 * seen_parts) << "of " << seen_parts;
  EXPECT_EQ(labels.size(), 25U) << "every part is seen from somewhere";
}

TEST(Generate, PutsTheGivenNumberOfPeopleIntoPictures) {
  Recipe recipe = small_recipe();
  recipe.people = {.none = 1.F, .one = 0.F, .two = 0.F, .three = 0.F, .four = 0.F};
  const Generator empty(recipe, {}, paper_body(), 3);
  for (const LabelledFrame& frame : frames_of(empty, 0, 8)) {
    EXPECT_TRUE(frame.parts.empty());
    EXPECT_TRUE(std::ranges::all_of(frame.labels, [](std::uint8_t label) { return label == kBackground; }));
  }
  recipe.people = {.none = 0.F, .one = 0.F, .two = 0.F, .three = 0.F, .four = 1.F};
  const Generator crowd(recipe, {}, paper_body(), 3);
  std::size_t people = 0;
  for (const LabelledFrame& frame : frames_of(crowd, 0, 20)) people += frame.parts.size();
  EXPECT_GE(people, 60U) << "of 80: some find no place";
}

TEST(Generate, RefusesInvalidRecipes) {
  const auto make = [](auto change) {
    return [change] {
      Recipe recipe = small_recipe();
      change(recipe);
      Generator(recipe, {}, paper_body(), 1);
    };
  };
  EXPECT_THAT(make([](Recipe& r) { r.sensor.preset = "kinekt"; }), ThrowsMessage<UsageError>(HasSubstr("kinect-v1")));
  EXPECT_THAT(make([](Recipe& r) { r.mounting = "roof"; }), ThrowsMessage<UsageError>(HasSubstr("ceiling")));
  EXPECT_THAT(make([](Recipe& r) { r.body.kind = "android"; }), ThrowsMessage<UsageError>(HasSubstr("builtin")));
  EXPECT_THAT(make([](Recipe& r) { r.body.kind = "makehuman"; }),
              ThrowsMessage<Error>(HasSubstr("vesalius assets makehuman")));
  EXPECT_THAT(make([](Recipe& r) {
                r.people = {0.F, 0.F, 0.F, 0.F, 0.F};
              }),
              ThrowsMessage<UsageError>(HasSubstr("expected a weight above 0")));
  EXPECT_THAT(make([](Recipe& r) { r.people.one = -1.F; }), ThrowsMessage<UsageError>(HasSubstr("people.one")));
  EXPECT_THAT(make([](Recipe& r) { r.sensor.height = 0; }), ThrowsMessage<UsageError>(HasSubstr("both or neither")));
}

}  // namespace
}  // namespace vesalius::synth
