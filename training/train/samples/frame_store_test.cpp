#include "train/samples/frame_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/error.h"

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

TEST(FrameStore, TakesFramesWhereTheyLieInABlock) {
  Random random(14);
  const FeatureConvention convention;
  FrameStore one_by_one{convention}, in_block{convention};
  const Camera wide{33, 20, 300.F, 300.F, 16.F, 10.F}, small{7, 5, 80.F, 80.F, 3.F, 2.F};
  std::string bytes(8, '\0');
  std::vector<FrameStore::InBlock> places;
  for (const Camera& camera : {wide, small, wide}) {
    const std::size_t f = one_by_one.add(camera, random_depth(camera.width, camera.height, random));
    const auto words = one_by_one.words(f);
    places.push_back({camera, bytes.size(), words.size()});
    bytes.append(reinterpret_cast<const char*>(words.data()), words.size_bytes());
  }
  in_block.add(small, random_depth(7, 5, random));
  in_block.add_block(HugeBuffer(bytes), places);
  in_block.add(small, random_depth(7, 5, random));
  ASSERT_EQ(in_block.size(), 5U);
  EXPECT_EQ(in_block.bytes(), one_by_one.bytes() + 64 * ((in_block.words(0).size_bytes() + 63) / 64) +
                                  64 * ((in_block.words(4).size_bytes() + 63) / 64));
  for (std::size_t f = 0; f < 3; ++f) {
    EXPECT_TRUE(std::ranges::equal(in_block.words(f + 1), one_by_one.words(f)));
    EXPECT_EQ(in_block.camera(f + 1), one_by_one.camera(f));
  }
  const std::size_t words = bytes.size() / 4;
  for (const FrameStore::InBlock& outside :
       {FrameStore::InBlock{small, 2, 1}, {small, bytes.size() + 4, 0}, {small, 4, words}, {Camera{}, 0, 1}}) {
    EXPECT_THROW(in_block.add_block(HugeBuffer(bytes), std::span(&outside, 1)), Error);
  }
  EXPECT_EQ(in_block.size(), 5U);
}

TEST(FrameStore, RefusesDepthOfAnotherSizeThanItsCamera) {
  FrameStore store{FeatureConvention{}};
  EXPECT_THROW(store.add({10, 10, 1.F, 1.F, 0.F, 0.F}, DepthImage(10, 9, 0)), Error);
  EXPECT_THROW(store.add({0, 0, 1.F, 1.F, 0.F, 0.F}, DepthImage(0, 0, 0)), Error);
  EXPECT_EQ(store.size(), 0U);
}

}  // namespace
}  // namespace vesalius
