#include "vesalius/forest/body_context.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/base/test_threads.h"

namespace vesalius {
namespace {

/// 280 pixels of focal length: a cell every second pixel.
const Camera kCamera{120, 90, 280.F, 280.F, 59.5F, 44.5F};
constexpr int kStep = 2;
constexpr int kTrees = 2;
constexpr int kWhole = 255 * kTrees;

const BodyModel& body() { return paper_body(); }

struct Picture {
  DepthImage depth{kCamera.width, kCamera.height, 2000};
  Posteriors posteriors{kCamera.width, kCamera.height, body().part_count() + 1, kWhole, {}};

  Picture() {
    posteriors.sums.assign(depth.size() * posteriors.classes, 0);
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) posteriors.at(u, v)[body().part_count()] = kWhole;
    }
  }
  void set(int u, int v, int part, int share) {
    std::uint16_t* of = posteriors.at(u, v);
    of[part] = static_cast<std::uint16_t>(of[part] + share);
    of[body().part_count()] = static_cast<std::uint16_t>(of[body().part_count()] - share);
  }
};

/// Returns a picture with random depth, holes, and posteriors of three parts.
Picture random_picture(std::uint64_t seed) {
  Picture picture;
  Random random(seed);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      picture.depth(u, v) = static_cast<std::uint16_t>(random.below(8) == 0 ? 0 : 1000 + random.below(3000));
      if (picture.depth(u, v) == 0) {
        std::fill_n(picture.posteriors.at(u, v), picture.posteriors.classes, std::uint16_t{0});
        continue;
      }
      for (const char* part : {"l_hand", "r_hand", "neck"}) {
        picture.set(u, v, body().find_part(part), static_cast<int>(random.below(kWhole / 3)));
      }
    }
  }
  return picture;
}

/// Returns trees that give every cell these odds of a body.
BoostedTrees always(float log_odds) { return {BodySurroundings::feature_count(body()), log_odds, {BoostedTree{}}}; }

/// Sums over the cells of a box, one by one.
struct Counted {
  double body = 0.0, hands = 0.0, depth_m = 0.0;
  int readings = 0, cells = 0;
};

Counted count(const Picture& picture, int column, int row, int radius) {
  const int l_hand = body().find_part("l_hand"), r_hand = body().find_part("r_hand");
  Counted counted;
  for (int r = row - radius; r <= row + radius; ++r) {
    for (int c = column - radius; c <= column + radius; ++c) {
      if (!picture.depth.contains(c * kStep, r * kStep)) continue;
      ++counted.cells;
      const int z_mm = picture.depth(c * kStep, r * kStep);
      if (z_mm == 0) continue;
      const std::uint16_t* of = picture.posteriors.at(c * kStep, r * kStep);
      counted.body += std::accumulate(of, of + body().part_count(), 0.0) / kWhole;
      counted.hands += (of[l_hand] + of[r_hand]) / static_cast<double>(kWhole);
      counted.depth_m += 1e-3 * z_mm;
      ++counted.readings;
    }
  }
  return counted;
}

TEST(BodySurroundings, AreMeansOverBoxesOfMetricSize) {
  const Picture picture = random_picture(3);
  const BodySurroundings around(picture.posteriors, picture.depth, kCamera, body());
  ASSERT_EQ(around.step(), kStep);
  ASSERT_EQ(around.columns(), 60);
  ASSERT_EQ(around.rows(), 45);
  const int kinds = 13, hand = part_slots(body())[body().find_part("l_hand")];
  ASSERT_EQ(BodySurroundings::feature_count(body()), 4 + kinds + 4 * (3 + kinds) + 14 * 3);
  const std::vector<std::string> names = BodySurroundings::feature_names(body());
  EXPECT_EQ(std::set(names.begin(), names.end()).size(), BodySurroundings::feature_count(body()));
  std::vector<float> features(BodySurroundings::feature_count(body()));
  int looked = 0;
  for (int row = 0; row < around.rows(); row += 4) {
    for (int column = 0; column < around.columns(); column += 3) {
      if (!around.is_open(column, row)) continue;
      ++looked;
      around.features(column, row, features.data());
      const double z_m = 1e-3 * picture.depth(column * kStep, row * kStep);
      EXPECT_NEAR(features[0], count(picture, column, row, 0).body, 1e-5);
      EXPECT_NEAR(features[4 + hand], count(picture, column, row, 0).hands, 1e-5);
      EXPECT_FLOAT_EQ(features[3], static_cast<float>(z_m));
      const float* box = features.data() + 4 + kinds;
      const float cells_per_m = 280.F / (features[3] * kStep);
      for (const float radius_m : {0.06F, 0.15F, 0.3F, 0.6F}) {
        const int radius = std::max(1, static_cast<int>(std::lround(radius_m * cells_per_m)));
        const Counted counted = count(picture, column, row, radius);
        EXPECT_NEAR(box[0], counted.body / counted.cells, 1e-4);
        EXPECT_NEAR(box[1], static_cast<double>(counted.readings) / counted.cells, 1e-5);
        EXPECT_NEAR(box[2], std::clamp(counted.depth_m / counted.readings - z_m, -1.5, 1.5), 1e-4);
        EXPECT_NEAR(box[3 + hand], counted.hands / counted.cells, 1e-4);
        box += 3 + kinds;
      }
    }
  }
  EXPECT_GT(looked, 100);
}

TEST(BodySurroundings, LookBesideThePixel) {
  Picture picture;
  const int neck = body().find_part("neck");
  picture.set(60, 44, neck, kWhole / 2);
  // 0.3 m to the right at 2 m are 21 cells; a box of 0.15 m goes 10.5 to both sides, which is rounded to 11.
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 100; u < kCamera.width; ++u) picture.set(u, v, neck, kWhole);
  }
  const BodySurroundings around(picture.posteriors, picture.depth, kCamera, body());
  std::vector<float> features(BodySurroundings::feature_count(body()));
  around.features(30, 22, features.data());
  const float* beside = features.data() + 4 + 13 + 4 * 16;
  EXPECT_NEAR(beside[0], 10.F / 20.F, 1e-5F) << "columns 40 to 59 are in the picture, 50 to 59 are the body";
  EXPECT_EQ(beside[3], 0.F) << "to the left there is none";
}

TEST(BodySurroundings, AreAskedForWhatMayBeABody) {
  Picture picture;
  const int neck = body().find_part("neck");
  picture.set(10, 10, neck, kWhole / 20);
  picture.set(20, 10, neck, kWhole / 50);
  picture.set(30, 10, neck, kWhole / 2);
  picture.depth(30, 10) = 0;
  picture.set(40, 10, neck, kWhole / 2);
  picture.posteriors.settled = Mask(kCamera.width, kCamera.height, 0);
  picture.posteriors.settled(40, 10) = 1;
  const BodySurroundings around(picture.posteriors, picture.depth, kCamera, body());
  EXPECT_TRUE(around.is_open(5, 5));
  EXPECT_FALSE(around.is_open(10, 5)) << "too little of a body";
  EXPECT_FALSE(around.is_open(15, 5)) << "no reading";
  EXPECT_FALSE(around.is_open(20, 5)) << "settled as background";
}

TEST(CorrectBodies, SharesBodyAndBackgroundOutAnewAndKeepsTheProportionsOfParts) {
  Picture picture;
  const int neck = body().find_part("neck"), hand = body().find_part("l_hand");
  for (int v = 20; v < 40; ++v) {
    for (int u = 30; u < 50; ++u) {
      picture.set(u, v, neck, 120);
      picture.set(u, v, hand, 60);
    }
  }
  Posteriors corrected;
  correct_bodies(always(std::log(0.8F / 0.2F)), picture.depth, kCamera, body(), picture.posteriors, corrected);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const std::uint16_t* of = corrected.at(u, v);
      ASSERT_EQ(std::accumulate(of, of + corrected.classes, 0), kWhole);
      const bool inside = u >= 30 && u < 50 && v >= 20 && v < 40;
      if (!inside) {
        EXPECT_EQ(of[body().part_count()], kWhole);
      } else {
        EXPECT_NEAR(of[neck] + of[hand], 0.8 * kWhole, 2.0);
        EXPECT_NEAR(of[neck], 2.0 * of[hand], 3.0);
      }
    }
  }
}

TEST(CorrectBodies, PixelsBetweenCellsFollowTheOneOfTheirDepth) {
  Picture picture;
  const int neck = body().find_part("neck");
  for (int u = 30; u <= 32; ++u) picture.set(u, 20, neck, 255);
  picture.depth(32, 20) = 3000;
  // Only cells at 3 m are bodies.
  BoostedTrees far = always(0.F);
  BoostedTree& tree = far.trees.front();
  tree.threshold.fill(std::numeric_limits<float>::infinity());
  tree.feature[0] = 3;
  tree.threshold[0] = 2.5F;
  tree.value.fill(-3.F);
  tree.value[BoostedTree::kLeaves / 2] = 3.F;
  for (const int z_mm : {2000, 3000, 2500}) {
    picture.depth(31, 20) = static_cast<std::uint16_t>(z_mm);
    Posteriors corrected;
    correct_bodies(far, picture.depth, kCamera, body(), picture.posteriors, corrected);
    const double share = *body_share(corrected, 31, 20, body().part_count());
    const double expected = z_mm == 2500   ? 0.5
                            : z_mm == 3000 ? 1.0 / (1.0 + std::exp(-3.0))
                                           : 1.0 / (1.0 + std::exp(3.0));
    EXPECT_NEAR(share, expected, 0.01) << z_mm;
  }
}

// Labels: threads
TEST(CorrectBodies, GivesTheSameForAnyNumberOfThreads) {
  const Picture picture = random_picture(7);
  BoostedTrees trees = always(-0.5F);
  Random random(8);
  trees.trees.resize(20);
  for (BoostedTree& tree : trees.trees) {
    for (std::uint16_t& feature : tree.feature) feature = static_cast<std::uint16_t>(random.below(trees.features));
    for (float& threshold : tree.threshold) threshold = static_cast<float>(random.uniform(-0.5, 1.0));
    for (float& value : tree.value) value = static_cast<float>(random.uniform(-0.3, 0.3));
  }
  std::vector<std::uint16_t> first;
  for_threads({1, 4}, [&] {
    Posteriors corrected;
    correct_bodies(trees, picture.depth, kCamera, body(), picture.posteriors, corrected);
    EXPECT_NE(corrected.sums, picture.posteriors.sums);
    if (first.empty()) first = corrected.sums;
    EXPECT_EQ(corrected.sums, first);
  });
}

}  // namespace
}  // namespace vesalius
