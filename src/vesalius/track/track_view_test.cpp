#include "vesalius/track/track_view.h"

#include <gtest/gtest.h>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

constexpr int kWidth = 320, kHeight = 240;
const Box kSomebody{100, 60, 60, 150};

/// A wall with a slope and a sensor's noise, and a board before it.
Frame room(int seed, int nearer_mm = 0, const Box& board = {}) {
  Random random(static_cast<std::uint32_t>(seed));
  DepthImage depth(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const bool on_board = u >= board.u && v >= board.v && u < board.u + board.width && v < board.v + board.height;
      const int noise_mm = int(random.below(61)) - 30;
      depth(u, v) = static_cast<std::uint16_t>((on_board ? 2500 : 3500 + 3 * u) - nearer_mm + noise_mm);
      if (random.below(20) == 0) depth(u, v) = 0;
    }
  }
  return depth_frame(std::move(depth), {kWidth, kHeight, 260.F, 260.F, 160.F, 120.F});
}

TEST(TrackView, IsTheSameInSpiteOfNoiseAndOfWhoMovesInTheRegion) {
  TrackView view;
  EXPECT_FALSE(view.unchanged(room(1), kSomebody)) << "nothing is known";
  view.take_frame(room(1, 0, kSomebody), 2.5, {{Eigen::Vector3f::UnitZ(), 3.F, 4.F}}, kSomebody);
  EXPECT_EQ(view.time_s(), 2.5);
  EXPECT_EQ(view.planes().size(), 1U);
  EXPECT_TRUE(view.unchanged(room(2, 0, kSomebody), kSomebody));
  Box moved = kSomebody;
  moved.u += 50;
  EXPECT_TRUE(view.unchanged(room(3, 0, moved), moved)) << "where somebody was before does not count either";
}

TEST(TrackView, ChangesBySomebodyNewByAMovedCameraAndByAnotherSize) {
  TrackView view;
  view.take_frame(room(1), 0.0, {}, kSomebody);
  EXPECT_FALSE(view.unchanged(room(2, 0, {220, 80, 45, 120}), kSomebody)) << "somebody came in";
  EXPECT_FALSE(view.unchanged(room(2, 300), kSomebody)) << "the camera went 30 cm";
  EXPECT_TRUE(view.unchanged(room(2, 5), kSomebody));
  Frame small = room(2);
  small.depth = crop(small.depth, {0, 0, 160, 120});
  EXPECT_FALSE(view.unchanged(small, kSomebody));
}

}  // namespace
}  // namespace vesalius
