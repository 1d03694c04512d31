#include "vesalius/base/pixel_grid.h"

#include <gmock/gmock.h>

#include "capsule/capsule_person.h"
#include "vesalius/base/random.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

int step_of(int width, int height, float focal, int wanted = 0) {
  return grid_step({width, height, focal, focal * 1.01F, 0.F, 0.F}, {wanted});
}

TEST(GridStep, IsTheSmallestThatLeavesFewEnoughPixels) {
  const auto step = [](int width, int height, int wanted = 0) { return step_of(width, height, 500.F, wanted); };
  EXPECT_EQ(step(320, 240), 1);
  EXPECT_EQ(step(512, 424), 1);
  EXPECT_EQ(step(500, 500), 1);
  EXPECT_EQ(step(501, 500), 2);
  EXPECT_EQ(step(640, 480), 2);
  EXPECT_EQ(step(848, 480), 2);
  EXPECT_EQ(step(1280, 720), 2);
  EXPECT_EQ(step(1024, 1024), 3);
  EXPECT_EQ(step(8000, 6000), 14);
  EXPECT_EQ(step(640, 480, 1), 1);
  EXPECT_EQ(step(320, 240, 3), 3);
  EXPECT_EQ(step(1, 1), 1);
}

TEST(GridStep, IsLargerWherePixelsOfALongFocalLengthAreEnough) {
  EXPECT_EQ(step_of(1280, 720, 640.F), 2) << "a RealSense D455";
  EXPECT_EQ(step_of(1280, 720, 899.F), 2);
  EXPECT_EQ(step_of(1280, 720, 900.F), 3) << "a D415";
  EXPECT_EQ(step_of(1280, 720, 1200.F), 4);
  EXPECT_EQ(step_of(1280, 720, 9000.F), 4) << "no fewer than a hundred thousand ask for it";
  EXPECT_EQ(step_of(640, 480, 1200.F), 2);
  EXPECT_EQ(step_of(512, 424, 900.F), 2);
  EXPECT_EQ(step_of(1920, 1080, 1060.F), 3);
  EXPECT_EQ(step_of(1280, 720, 900.F, 1), 1);
}

TEST(EveryNth, KeepsThePointsOfPixels) {
  CapsuleScene scene;
  scene.people.emplace_back();
  Frame frame = render(scene, {163, 121, 131.F, 129.F, 80.2F, 61.7F}, paper_body()).frame;
  frame.name = "0007";
  frame.time_s = 2.5;
  for (const int step : {1, 2, 3, 200}) {
    const Frame coarse = every_nth(frame, step);
    ASSERT_EQ(coarse.depth.width(), (163 + step - 1) / step);
    ASSERT_EQ(coarse.depth.height(), (121 + step - 1) / step);
    EXPECT_NO_THROW(check(coarse));
    EXPECT_EQ(coarse.name, "0007");
    EXPECT_EQ(coarse.time_s, 2.5);
    for (int v = 0; v < coarse.depth.height(); ++v) {
      for (int u = 0; u < coarse.depth.width(); ++u) {
        const Eigen::Vector3f whole = point_at(frame.camera, frame.depth, step * u, step * v);
        ASSERT_LT((point_at(coarse.camera, coarse.depth, u, v) - whole).norm(), 1e-4F);
        ASSERT_EQ(coarse.colour(u, v), frame.colour(step * u, step * v));
      }
    }
  }
  frame.colour = {};
  EXPECT_TRUE(every_nth(frame, 2).colour.empty());
  EXPECT_EQ(every_nth(frame, 1).camera, frame.camera);
}

TEST(InBlocks, HoldsTheBoxInWholeBlocksOfThePicture) {
  Random random(7);
  const auto below = [&](int end) { return int(random.below(static_cast<std::uint32_t>(end))); };
  for (int i = 0; i < 2000; ++i) {
    const Camera camera{1 + below(900), 1 + below(900), 500.F, 500.F, 0.F, 0.F};
    const int step = 1 + below(3), width = 1 + below(camera.width), height = 1 + below(camera.height);
    const Box box{below(camera.width - width + 1), below(camera.height - height + 1), width, height};
    const Box blocks = in_blocks(box, camera, step);
    ASSERT_LE(blocks.u, box.u);
    ASSERT_LE(blocks.v, box.v);
    ASSERT_GE(blocks.u + blocks.width, box.u + box.width);
    ASSERT_GE(blocks.v + blocks.height, box.v + box.height);
    ASSERT_GE(std::min(blocks.u, blocks.v), 0);
    ASSERT_LE(blocks.u + blocks.width, camera.width);
    ASSERT_LE(blocks.v + blocks.height, camera.height);
    ASSERT_EQ(blocks.u % (4 * step), 0);
    ASSERT_EQ(blocks.v % (4 * step), 0);
    // Whole blocks but at the picture's end.
    ASSERT_TRUE(blocks.width % (32 * step) == 0 || blocks.u + blocks.width > camera.width - 4 * step);
    ASSERT_LT(blocks.width, box.width + (32 + 8 + 4) * step);
  }
}

TEST(Cropped, KeepsThePointsOfPixels) {
  CapsuleScene scene;
  scene.people.emplace_back();
  Frame frame = render(scene, {163, 121, 131.F, 129.F, 80.2F, 61.7F}, paper_body()).frame;
  frame.time_s = 2.5;
  frame.up = -Eigen::Vector3f::UnitY();
  const Box box{40, 20, 64, 70};
  const Frame part = cropped(frame, box);
  EXPECT_NO_THROW(check(part));
  EXPECT_EQ(part.time_s, 2.5);
  EXPECT_EQ(part.up, frame.up);
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) {
      const Eigen::Vector3f whole = point_at(frame.camera, frame.depth, box.u + u, box.v + v);
      ASSERT_LT((point_at(part.camera, part.depth, u, v) - whole).norm(), 1e-4F);
      ASSERT_EQ(part.colour(u, v), frame.colour(box.u + u, box.v + v));
    }
  }
  const DepthImage again = uncropped(part.depth, box, frame.camera, std::uint16_t{7});
  EXPECT_EQ(crop(again, box), part.depth);
  EXPECT_EQ(again(0, 0), 7);
  EXPECT_EQ(again(box.u + box.width, box.v), 7);
}

TEST(GridGuide, TakesTheValueOfTheNeighbourWithTheNearestDepth) {
  DepthImage depth(5, 3, 2000);
  depth(2, 0) = 1000;  // a person in front of a wall
  depth(1, 0) = 1010;
  depth(3, 0) = 1990;
  depth(3, 1) = 0;
  depth(1, 2) = 1500;  // between both: neither is near enough
  LabelImage coarse(3, 2, 9);
  coarse(1, 0) = 4;
  const LabelImage all = GridGuide(depth, 2).enlarge(coarse, kBackground);
  ASSERT_TRUE(all.same_size(depth));
  EXPECT_EQ(all(2, 0), 4);
  EXPECT_EQ(all(1, 0), 4);
  EXPECT_EQ(all(3, 0), 9);
  EXPECT_EQ(all(2, 1), 9) << "of the row below, for the one above is a metre nearer";
  EXPECT_EQ(all(3, 1), kBackground) << "no reading";
  EXPECT_EQ(all(1, 2), kBackground);
  EXPECT_EQ(all(4, 2), 9);
}

/// Enlarges as the header describes, pixel by pixel over the whole grid.
LabelImage enlarge_slowly(const LabelImage& coarse, const DepthImage& depth, int step) {
  LabelImage out(depth.width(), depth.height(), kBackground);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const double z = 1e-3 * depth(u, v);
      int least = 100000;
      for (int j = 0; depth(u, v) != 0 && j < coarse.height(); ++j) {
        for (int i = 0; i < coarse.width(); ++i) {
          if (std::abs(i * step - u) >= step || std::abs(j * step - v) >= step) continue;
          const int there = depth(i * step, j * step);
          const int apart = std::abs(there - depth(u, v));
          if (there == 0 || apart > 50 + static_cast<int>(3.0 * z * z) || apart >= least) continue;
          least = apart;
          out(u, v) = coarse(i, j);
        }
      }
    }
  }
  return out;
}

// Labels: threads
TEST(GridGuideThreads, AgreeWithThePlainSearchForAnyNumber) {
  Random random(41);
  for (int trial = 0; trial < 40; ++trial) {
    const int step = 1 + static_cast<int>(random.below(4));
    DepthImage depth(1 + static_cast<int>(random.below(40)), 1 + static_cast<int>(random.below(40)));
    for (auto& mm : depth) mm = random.below(6) == 0 ? 0 : static_cast<std::uint16_t>(1000 + 30 * random.below(12));
    LabelImage coarse = every_nth(LabelImage(depth.width(), depth.height(), 0), step);
    for (auto& label : coarse) label = static_cast<std::uint8_t>(random.below(7));
    const GridGuide guide(depth, step);
    const LabelImage expected = enlarge_slowly(coarse, depth, step);
    for_threads({1, 3}, [&] { ASSERT_EQ(guide.enlarge(coarse, kBackground), expected) << trial; });
  }
}

TEST(GridGuide, NeedsOnlyABoxOfTheGrid) {
  DepthImage depth(23, 17, 1500);
  const GridGuide guide(depth, 3);
  Mask coarse(8, 6, 0);
  for (int v = 2; v < 5; ++v) {
    for (int u = 7; u < 8; ++u) coarse(u, v) = 1;
  }
  coarse(6, 3) = 1;
  Mask enlarged(23, 17, 0);
  const Box box = guide.whole_box(bounding_box(coarse));
  guide.each(
      box, [&](int column, int row) { return coarse(column, row) != 0; },
      [&](int u, int v, int column, int row) { enlarged(u, v) = coarse(column, row); });
  EXPECT_EQ(enlarged, guide.enlarge(coarse, std::uint8_t{0}));
  EXPECT_EQ(guide.whole_box(Box{}).width, 0);
  EXPECT_EQ(guide.enlarge(Mask(), std::uint8_t{0}), Mask(23, 17, 0)) << "labels of a candidate without pixels";
}

TEST(GridGuide, RefusesAStepOfZero) { EXPECT_THROW(GridGuide(DepthImage(2, 2), 0), Error); }

}  // namespace
}  // namespace vesalius
