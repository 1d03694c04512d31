#include "train/samples/depth_tiles.h"

#include <gmock/gmock.h>

#include <array>

#include "capsule/capsule_person.h"
#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"

namespace vesalius {
namespace {

/// Returns tiles of every width of code with holes. Readings within a patch differ by up to `spread`.
DepthImage patches(int width, int height, Random& random) {
  constexpr std::array<std::uint32_t, 6> kSpreads{1, 15, 16, 255, 256, 64000};
  DepthImage depth(width, height, 0);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto spread = kSpreads[(u / 8 + v / 4) % 6];
      if (random.below(5) != 0) depth(u, v) = static_cast<std::uint16_t>(1 + 77 * (u / 16) + random.below(spread));
    }
  }
  return depth;
}

void expect_same_pixels(const DepthImage& depth) {
  const std::vector<std::uint32_t> words = pack_tiles(depth);
  const PackedTiles packed = packed_tiles({depth.width(), depth.height()}, words.data());
  for_each_target([&](const char* target) {
    std::vector<std::uint16_t> tiles(packed.grid.tiles() * TileGrid::kPixels, 12345);
    unpack_tiles(packed, 7777, tiles.data());
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        const std::size_t at = packed.grid.tile_of(u, v) * TileGrid::kPixels + TileGrid::in_tile(u, v);
        ASSERT_EQ(tiles[at], depth(u, v) != 0 ? depth(u, v) : 7777) << target << ' ' << u << ' ' << v;
        ASSERT_EQ(packed.depth_mm(u, v), depth(u, v)) << u << ' ' << v;
      }
    }
  });
}

TEST(DepthTiles, KeepEveryPixelOfFramesOfAnySize) {
  Random random(13);
  for (const auto& [width, height] : {std::pair{320, 240}, std::pair{1, 1}, std::pair{9, 5}, std::pair{37, 21}}) {
    expect_same_pixels(patches(width, height, random));
  }
}

TEST(DepthTiles, KeepTheLargestAndTheSmallestReading) {
  DepthImage depth(8, 4, 0);
  expect_same_pixels(depth);
  depth(3, 1) = 65535;
  expect_same_pixels(depth);
  depth(4, 2) = 1;
  expect_same_pixels(depth);
  depth.fill(65535);
  expect_same_pixels(depth);
}

TEST(DepthTiles, ReachTheLastTileOfTheWidestFrame) {
  DepthImage depth(kLargestTiledSide, 5, 0);
  for (int u = 0; u < depth.width(); ++u) {
    for (int v = 0; v < depth.height(); ++v) depth(u, v) = static_cast<std::uint16_t>((u * 7919 + v) % 65536);
  }
  const std::vector<std::uint32_t> words = pack_tiles(depth);
  const PackedTiles packed = packed_tiles({depth.width(), depth.height()}, words.data());
  for (const int v : {0, 3, 4}) {
    for (int u = depth.width() - 40; u < depth.width(); ++u) ASSERT_EQ(packed.depth_mm(u, v), depth(u, v));
  }
}

TEST(DepthTiles, TakeThreeFifthsOfARenderedFrame) {
  CapsuleScene scene;
  scene.people = {CapsulePerson{}};
  LabelledFrame labelled = render(scene, {320, 240, 262.F, 262.F, 159.5F, 119.5F}, paper_body());
  EXPECT_LT(pack_tiles(labelled.frame.depth).size() * 4, 320U * 240U * 5 / 4);
  add_sensor_noise(labelled.frame, 1);
  EXPECT_LT(pack_tiles(labelled.frame.depth).size() * 4, 320U * 240U * 3 / 2);
}

}  // namespace
}  // namespace vesalius
