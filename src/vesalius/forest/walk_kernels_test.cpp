#include "vesalius/forest/walk_kernels.h"

#include <gtest/gtest.h>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"
#include "vesalius/forest/test_trees.h"

namespace vesalius {
namespace {

using test::random_depth;
using test::random_tree;
using test::TreeKind;

void expect_leaves_of_walk(const Tree& tree, const FeatureConvention& convention, const DepthImage& depth,
                           const Camera& camera) {
  const OffsetScaler scaler(convention, camera);
  const PackedTree packed = pack(tree, convention);
  const PaddedDepth padded(depth, convention);
  const WalkPixels pixels(depth, 0, depth.height(), scaler, convention);
  std::vector<std::uint32_t> expected;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) == 0) continue;
      const TreeLeaf& leaf = walk(tree, depth, convention, scaler.at(depth(u, v)), u, v);
      expected.push_back(static_cast<std::uint32_t>(&leaf - tree.leaves.data()));
    }
  }
  ASSERT_EQ(pixels.size(), expected.size());
  for_each_target([&](const char* target) {
    std::vector<std::uint32_t> leaves(pixels.padded_size(), 12345);
    walk_pixels(packed, padded, pixels, leaves.data());
    leaves.resize(pixels.size());
    EXPECT_EQ(leaves, expected) << target << (packed.wide ? " wide " : " compact ") << depth.width() << 'x'
                                << depth.height() << " clip " << convention.clip_mm;
  });
}

const FeatureConvention kConventions[] = {
    {},
    {.clip_mm = 1000},
    {.hole_mm = 9000, .outside_mm = 65535, .clip_mm = 60000},
    {.offset_unit = 1.F, .reference_focal_px = 640.F, .hole_mm = 1, .outside_mm = 0},
};

TEST(WalkKernels, FindTheLeavesOfThePlainWalkOnEveryInstructionSet) {
  const TreeKind kinds[] = {
      {.nodes = 0},
      {.nodes = 1},
      {.nodes = 700},
      {.nodes = 300, .max_depth = 60, .max_offset = 128},
      {.nodes = 300, .max_offset = kMaxOffset, .max_threshold_mm = 32767},
      {.nodes = 300, .max_threshold_mm = 32767},
      {.nodes = 300, .shared = true},
  };
  Random random(21);
  for (const TreeKind& kind : kinds) {
    for (const FeatureConvention& convention : kConventions) {
      const Tree tree = random_tree(random, kind);
      for (const auto& [width, height] : {std::pair{1, 1}, std::pair{37, 5}, std::pair{64, 48}, std::pair{3, 130}}) {
        const Camera camera{width, height, 60.F, 95.F, 0.F, 0.F};
        expect_leaves_of_walk(tree, convention, random_depth(random, width, height), camera);
      }
    }
  }
}

TEST(WalkKernels, KeepTheFurthestProbesOfTheLargestPictureOutside) {
  Random random(22);
  const FeatureConvention convention;
  for (const auto& [width, height] : {std::pair{PaddedDepth::kMaxSide, 2}, std::pair{2, PaddedDepth::kMaxSide}}) {
    const Camera camera{width, height, 1e6F, 1e6F, 0.F, 0.F};  // every offset is scaled by the most, 32
    for (const int max_offset : {127, kMaxOffset}) {
      const Tree tree = random_tree(random, {.nodes = 40, .max_offset = max_offset, .max_threshold_mm = 9000});
      expect_leaves_of_walk(tree, convention, random_depth(random, width, height), camera);
    }
  }
}

TEST(WalkPixels, AreThePixelsWithAReading) {
  DepthImage depth(3, 3, 0);
  depth(2, 0) = 500;
  depth(0, 1) = 1000;
  depth(1, 2) = 64000;
  const FeatureConvention convention{.clip_mm = 2000};
  const OffsetScaler scaler(convention, {3, 3, 100.F, 50.F, 1.F, 1.F});
  const WalkPixels pixels(depth, 1, 3, scaler, convention);
  ASSERT_EQ(pixels.size(), 2U);
  EXPECT_EQ(pixels.padded_size(), WalkPixels::kBlock);
  EXPECT_EQ(pixels.column(WalkPixels::kU)[1], 1);
  EXPECT_EQ(pixels.column(WalkPixels::kV)[1], 2);
  EXPECT_EQ(pixels.column(WalkPixels::kScaleU)[0], scaler.at(1000).u);
  EXPECT_EQ(pixels.column(WalkPixels::kScaleV)[0], scaler.at(1000).v);
  const auto halves = [](int mm) { return (mm - 32768) * 65536 + ((mm - 32768) & 0xFFFF); };
  EXPECT_EQ(pixels.column(WalkPixels::kLow)[0], halves(0)) << "no depth is negative";
  EXPECT_EQ(pixels.column(WalkPixels::kHigh)[0], halves(3000));
  EXPECT_EQ(pixels.column(WalkPixels::kLow)[1], halves(62000));
  EXPECT_EQ(pixels.column(WalkPixels::kHigh)[1], halves(65535)) << "nor beyond 16 bits";
}

}  // namespace
}  // namespace vesalius
