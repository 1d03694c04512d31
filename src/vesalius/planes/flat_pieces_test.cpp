#include "vesalius/planes/flat_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

constexpr double kNoneIsSurelyLarge = 1e30;
using Pieces = std::set<std::set<int>>;

/// Blotches of flat pixels at depths a few steps apart: some steps are just within a piece, some just beyond.
void make_blotches(Random& random, DepthImage& depth, Mask& flat) {
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = static_cast<std::uint16_t>(1498 + 59 * random.below(3) + random.below(4));
    flat[i] = random.below(4) != 0 ? 1 : 0;
  }
}

/// Flood fill: neighbours belong together if their step is at most 30 mm and a fiftieth of the farther one's depth.
Pieces flooded_pieces(const DepthImage& depth, const Mask& flat) {
  Pieces all;
  Mask seen(flat.width(), flat.height(), 0);
  for (int first = 0; first < static_cast<int>(flat.size()); ++first) {
    if (flat[first] == 0 || seen[first] != 0) continue;
    std::vector<int> open{first};
    seen[first] = 1;
    for (std::size_t head = 0; head < open.size(); ++head) {
      const int u = open[head] % flat.width(), v = open[head] / flat.width();
      for (const auto& [du, dv] : {std::pair{-1, 0}, std::pair{1, 0}, std::pair{0, -1}, std::pair{0, 1}}) {
        if (!flat.contains(u + du, v + dv) || flat(u + du, v + dv) == 0 || seen(u + du, v + dv) != 0) continue;
        const int here = depth(u, v), there = depth(u + du, v + dv);
        if (std::abs(there - here) > 30 + std::max(here, there) / 50) continue;
        seen(u + du, v + dv) = 1;
        open.push_back((v + dv) * flat.width() + u + du);
      }
    }
    all.insert({open.begin(), open.end()});
  }
  return all;
}

/// The pieces that are asked about where none is surely large.
Pieces asked_pieces(const DepthImage& depth, const Mask& flat) {
  Pieces asked;
  const Mask kept = without_body_pieces(depth, flat, kNoneIsSurelyLarge, [&](const std::vector<int>& pixels) {
    EXPECT_TRUE(std::ranges::is_sorted(pixels));
    EXPECT_TRUE(asked.insert({pixels.begin(), pixels.end()}).second);
    return true;
  });
  EXPECT_EQ(kept, flat);
  return asked;
}

/// Row-major pixels of `pieces` of a picture in the one that is turned by half.
Pieces turned(const Pieces& pieces, int pixels) {
  Pieces out;
  for (const std::set<int>& piece : pieces) {
    std::set<int> other;
    for (const int pixel : piece) other.insert(pixels - 1 - pixel);
    out.insert(other);
  }
  return out;
}

/// A square of flat pixels, a metre away, in the middle of a picture that is `around_mm` away.
struct Square {
  DepthImage depth{40, 40, 0};
  Mask flat{40, 40, 0};

  explicit Square(std::uint16_t around_mm) {
    depth.fill(around_mm);
    for (int v = 15; v < 25; ++v) {
      for (int u = 15; u < 25; ++u) {
        depth(u, v) = 1000;
        flat(u, v) = 1;
      }
    }
  }

  bool kept_if(bool large) const {
    const Mask out =
        without_body_pieces(depth, flat, kNoneIsSurelyLarge, [&](const std::vector<int>&) { return large; });
    EXPECT_TRUE(out == flat || out == Mask(40, 40, 0));
    return out == flat;
  }
};

TEST(FlatPieces, AreWhatAFloodFillReaches) {
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    const int width = 1 + static_cast<int>(random.below(20)), height = 1 + static_cast<int>(random.below(20));
    DepthImage depth(width, height);
    Mask flat(width, height);
    make_blotches(random, depth, flat);
    EXPECT_EQ(asked_pieces(depth, flat), flooded_pieces(depth, flat)) << width << 'x' << height;
  }
}

TEST(FlatPieces, AreTheSameFromWhateverCornerOneStarts) {
  Random random(8);
  for (int round = 0; round < 50; ++round) {
    DepthImage depth(17, 13);
    Mask flat(17, 13);
    make_blotches(random, depth, flat);
    const Pieces pieces = asked_pieces(depth, flat);
    std::reverse(depth.begin(), depth.end());
    std::reverse(flat.begin(), flat.end());
    EXPECT_EQ(asked_pieces(depth, flat), turned(pieces, static_cast<int>(flat.size())));
  }
}

TEST(FlatPieces, EndWhereTheStepIsTooLargeForTheFartherPixel) {
  const auto pieces_of = [](std::uint16_t a, std::uint16_t b) {
    DepthImage across(2, 1, a), down(1, 2, a);
    across(1, 0) = down(0, 1) = b;
    const std::size_t count = asked_pieces(across, Mask(2, 1, 1)).size();
    EXPECT_EQ(asked_pieces(down, Mask(1, 2, 1)).size(), count);
    return count;
  };
  EXPECT_EQ(pieces_of(1000, 1051), 1U);  // 30 mm and a fiftieth of 1051
  EXPECT_EQ(pieces_of(1051, 1000), 1U);
  EXPECT_EQ(pieces_of(1000, 1052), 2U);
  EXPECT_EQ(pieces_of(1052, 1000), 2U);
}

TEST(FlatPieces, ACombIsOnePiece) {
  const DepthImage depth(7, 5, 1000);
  Mask flat(7, 5, 0);
  const std::array<const char*, 5> rows{"#.#.#.#", "#.#.#.#", "#######", ".......", "#######"};
  for (int v = 0; v < 5; ++v) {
    for (int u = 0; u < 7; ++u) flat(u, v) = rows[v][u] == '#' ? 1 : 0;
  }
  const Pieces pieces = asked_pieces(depth, flat);
  ASSERT_EQ(pieces.size(), 2U);
  std::multiset<std::size_t> sizes;
  for (const std::set<int>& piece : pieces) sizes.insert(piece.size());
  EXPECT_EQ(sizes, (std::multiset<std::size_t>{7, 15}));
}

TEST(FlatPieces, SurelyLargeOnesAreNotAskedAbout) {
  const DepthImage depth(10, 10, 1000);
  const Mask flat(10, 10, 1);
  const auto refuse = [](const std::vector<int>&) { return ADD_FAILURE(), false; };
  EXPECT_EQ(without_body_pieces(depth, flat, 1e8, refuse), flat);
  int asked = 0;
  const auto count = [&](const std::vector<int>&) { return ++asked != 0; };
  EXPECT_EQ(without_body_pieces(depth, flat, 1.01e8, count), flat);
  EXPECT_EQ(asked, 1);
}

TEST(FlatPieces, ASmallOneThatStandsByItselfIsDropped) {
  EXPECT_FALSE(Square(3000).kept_if(false));
  EXPECT_TRUE(Square(3000).kept_if(true));
}

TEST(FlatPieces, ASmallOneThatSomethingNearerHidesStays) {
  EXPECT_TRUE(Square(500).kept_if(false));
  EXPECT_TRUE(Square(949).kept_if(false));
  EXPECT_FALSE(Square(950).kept_if(false));  // 30 mm and a fiftieth of a metre: as near as the piece itself
}

TEST(FlatPieces, ASmallOneWithoutReadingsAroundStays) { EXPECT_TRUE(Square(0).kept_if(false)); }

TEST(FlatPieces, NothingFlatHasNoPieces) {
  const Mask none(6, 4, 0);
  const auto refuse = [](const std::vector<int>&) { return ADD_FAILURE(), false; };
  EXPECT_EQ(without_body_pieces(DepthImage(6, 4, 1000), none, kNoneIsSurelyLarge, refuse), none);
}

}  // namespace
}  // namespace vesalius
