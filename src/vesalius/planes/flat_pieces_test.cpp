#include "vesalius/planes/flat_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

/// Blotches of flat pixels at depths a few steps apart, among them steps that count from one side only.
void make_blotches(Random& random, DepthImage& depth, Mask& flat) {
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = static_cast<std::uint16_t>(1498 + 59 * random.below(3) + random.below(4));
    flat[i] = random.below(4) != 0 ? 1 : 0;
  }
}

/// Everything that can be reached from each pixel that no earlier piece has.
std::set<std::set<int>> plain_pieces(const DepthImage& depth, const Mask& flat) {
  std::set<std::set<int>> all;
  Mask seen(flat.width(), flat.height(), 0);
  for (int first = 0; first < static_cast<int>(flat.size()); ++first) {
    if (flat[first] == 0 || seen[first] != 0) continue;
    std::vector<int> open{first};
    seen[first] = 1;
    for (std::size_t head = 0; head < open.size(); ++head) {
      const int u = open[head] % flat.width(), v = open[head] / flat.width();
      for (const auto& [du, dv] : {std::pair{-1, 0}, std::pair{1, 0}, std::pair{0, -1}, std::pair{0, 1}}) {
        if (!flat.contains(u + du, v + dv) || flat(u + du, v + dv) == 0 || seen(u + du, v + dv) != 0) continue;
        if (std::abs(depth(u + du, v + dv) - depth(u, v)) > 30 + depth(u, v) / 50) continue;
        seen(u + du, v + dv) = 1;
        open.push_back((v + dv) * flat.width() + u + du);
      }
    }
    all.insert({open.begin(), open.end()});
  }
  return all;
}

TEST(FlatPieces, AreThePixelsReachedFromOneOfThem) {
  Random random(7);
  for (int round = 0; round < 50; ++round) {
    DepthImage depth(17, 13);
    Mask flat(17, 13);
    make_blotches(random, depth, flat);
    std::set<std::set<int>> asked;
    const Mask kept = without_body_pieces(depth, flat, 1e30, [&](const std::vector<int>& pixels) {
      EXPECT_TRUE(asked.insert({pixels.begin(), pixels.end()}).second);
      return true;
    });
    EXPECT_EQ(asked, plain_pieces(depth, flat));
    EXPECT_EQ(kept, flat);
  }
}

TEST(FlatPieces, SurelyLargeOnesAreNotAskedAbout) {
  const DepthImage depth(10, 10, 1000);
  const Mask flat(10, 10, 1);
  const auto refuse = [](const std::vector<int>&) { return ADD_FAILURE(), false; };
  EXPECT_EQ(without_body_pieces(depth, flat, 1e8, refuse), flat);
}

TEST(FlatPieces, DropsASmallOneThatStandsByItself) {
  DepthImage depth(40, 40, 3000);
  Mask flat(40, 40, 0);
  for (int v = 15; v < 25; ++v) {
    for (int u = 15; u < 25; ++u) {
      depth(u, v) = 1000;
      flat(u, v) = 1;
    }
  }
  const auto small = [](const std::vector<int>&) { return false; };
  EXPECT_EQ(without_body_pieces(depth, flat, 1e30, small), Mask(40, 40, 0));
  for (std::uint16_t& mm : depth) mm = mm == 3000 ? 500 : mm;  // all about it is in front
  EXPECT_EQ(without_body_pieces(depth, flat, 1e30, small), flat);
}

}  // namespace
}  // namespace vesalius
