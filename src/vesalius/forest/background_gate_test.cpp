#include "vesalius/forest/background_gate.h"

#include <gmock/gmock.h>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

constexpr int kStep = BackgroundGate::kStep;

/// Returns posteriors of one tree with two classes, the second of which is the background.
Posteriors even(const DepthImage& depth, std::uint16_t background) {
  Posteriors p{depth.width(), depth.height(), 2, 255, {}};
  for (std::size_t i = 0; i < depth.size(); ++i) p.sums.insert(p.sums.end(), {std::uint16_t{0}, background});
  return p;
}

std::vector<std::uint8_t> row_of(const BackgroundGate& gate, int v, int width) {
  std::vector<std::uint8_t> shut(static_cast<std::size_t>(width), 7);
  gate.row(v, shut.data());
  return shut;
}

TEST(TakeFromGrid, TakesTheNearestInDepth) {
  DepthImage depth(5, 5, 1000);
  Posteriors p = even(depth, 0);
  depth(4, 0) = 1020;
  depth(0, 4) = 990;
  depth(2, 2) = 1015;
  p.at(4, 0)[0] = 77;
  EXPECT_TRUE(take_from_grid(depth, kStep, 2, 2, p));
  EXPECT_EQ(p.at(2, 2)[0], 77);
  depth(2, 2) = 940;  // 50 mm from the nearest
  EXPECT_TRUE(take_from_grid(depth, kStep, 2, 2, p));
  depth(2, 2) = 939;
  EXPECT_FALSE(take_from_grid(depth, kStep, 2, 2, p));
}

TEST(TakeFromGrid, LooksOnlyAtBothEnds) {
  DepthImage depth(9, 9, 0);
  depth(4, 2) = 1000;
  depth(8, 0) = depth(8, 4) = depth(0, 0) = 1000;  // none of them is an end of the column from (4, 0) to (4, 4)
  Posteriors p = even(depth, 0);
  EXPECT_FALSE(take_from_grid(depth, kStep, 4, 2, p));
  depth(4, 4) = 1000;
  EXPECT_TRUE(take_from_grid(depth, kStep, 4, 2, p));
}

TEST(BackgroundGate, OpensAroundUncertainPixels) {
  const DepthImage depth(17, 13, 2000);
  Posteriors p = even(depth, 204);
  p.at(8, 4)[1] = 203;  // one below 0.8
  const BackgroundGate gate(depth, p, 0.8F);
  for (int v = 0; v < depth.height(); ++v) {
    const std::vector<std::uint8_t> shut = row_of(gate, v, depth.width());
    for (int u = 0; u < depth.width(); ++u) {
      const bool near = std::abs(u - 8) < kStep && std::abs(v - 4) < kStep;
      EXPECT_EQ(shut[u], near ? 0 : 1) << u << ' ' << v;
    }
  }
}

TEST(BackgroundGate, IgnoresHolesButNeedsSomeReading) {
  DepthImage depth(5, 5, 2000);
  Posteriors p = even(depth, 255);
  depth(0, 0) = depth(4, 0) = depth(0, 4) = 0;
  EXPECT_THAT(row_of(BackgroundGate(depth, p, 0.8F), 2, 5), testing::ElementsAre(0, 1, 1, 1, 1));
  depth(4, 4) = 0;
  EXPECT_THAT(row_of(BackgroundGate(depth, p, 0.8F), 2, 5), testing::Each(0));
}

TEST(BackgroundGate, TakesPicturesOfAnySize) {
  Random random(3);
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(3, 2), std::pair(4, 9), std::pair(5, 4)}) {
    DepthImage depth(width, height, 1500);
    const BackgroundGate gate(depth, even(depth, 255), 0.8F);
    for (int v = 0; v < height; ++v) EXPECT_THAT(row_of(gate, v, width), testing::Each(1));
  }
}

}  // namespace
}  // namespace vesalius
