#include "train/frame_store.h"

#include <gtest/gtest.h>

#include "vesalius/base/error.h"
#include "vesalius/base/random.h"

namespace vesalius {
namespace {

DepthImage random_depth(int width, int height, Random& random) {
  DepthImage depth(width, height, 0);
  for (auto& mm : depth) mm = static_cast<std::uint16_t>(random.below(2) * random.below(65536));
  return depth;
}

TEST(FrameStore, KeepsFramesOfDifferentSizes) {
  Random random(13);
  FeatureConvention convention;
  convention.hole_mm = 9000;
  convention.outside_mm = 60000;
  FrameStore store{convention};
  std::vector<DepthImage> frames;
  std::size_t bytes = 0;
  for (const auto& [width, height] : {std::pair{320, 240}, std::pair{1, 1}, std::pair{9, 5}, std::pair{640, 480}}) {
    frames.push_back(random_depth(width, height, random));
    EXPECT_EQ(store.add({width, height, 300.F, 300.F, 0.F, 0.F}, frames.back()), frames.size() - 1);
    bytes += FrameStore::frame_bytes(frames.back());
    EXPECT_EQ(store.bytes(), bytes);
    EXPECT_LE(FrameStore::frame_bytes(frames.back()), FrameStore::most_frame_bytes(width, height));
  }
  FrameUnpacker unpack(store);
  for (const std::size_t f : {0U, 1U, 1U, 3U, 2U, 0U}) {
    const TiledDepth& tiled = unpack(f);
    ASSERT_EQ(tiled.grid.width, frames[f].width());
    EXPECT_EQ(tiled.tiles[tiled.grid.tiles() * TileGrid::kPixels], 60000);
    for (int v = 0; v < frames[f].height(); ++v) {
      for (int u = 0; u < frames[f].width(); ++u) {
        ASSERT_EQ(tiled.depth_mm(u, v), frames[f](u, v) != 0 ? frames[f](u, v) : 9000);
        ASSERT_EQ(store[f].depth.depth_mm(u, v), frames[f](u, v));
      }
    }
  }
}

TEST(FrameStore, RefusesDepthOfAnotherSizeThanItsCamera) {
  FrameStore store{FeatureConvention{}};
  EXPECT_THROW(store.add({10, 10, 1.F, 1.F, 0.F, 0.F}, DepthImage(10, 9, 0)), Error);
  EXPECT_THROW(store.add({0, 0, 1.F, 1.F, 0.F, 0.F}, DepthImage(0, 0, 0)), Error);
  EXPECT_EQ(store.size(), 0U);
}

}  // namespace
}  // namespace vesalius
