#include "dataset/turned_truth.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

/// A picture of 5 x 3 pixels with one reading right of the principal point and one person there.
TrueFrame small_frame() {
  TrueFrame frame;
  frame.frame.camera = {5, 3, 10.F, 10.F, 2.F, 1.F};
  frame.frame.depth = DepthImage(5, 3, 0);
  frame.frame.depth(4, 1) = 2000;
  frame.truth.person = Image<std::uint8_t>(5, 3, kBackground);
  frame.truth.person(4, 1) = 0;
  frame.truth.parts = {{point_at(frame.frame.camera, frame.frame.depth, 4, 1)}};
  frame.truth.up = Vector3f(0.F, -1.F, 0.F);
  return frame;
}

TEST(TurnedTruth, ByNothingIsTheSame) {
  const TrueFrame same = turned(small_frame(), 0.0);
  EXPECT_EQ(same.frame.depth, small_frame().frame.depth);
  EXPECT_EQ(same.truth.person, small_frame().truth.person);
  EXPECT_EQ(same.frame.camera.cx, 2.F);
}

TEST(TurnedTruth, ByAQuarterSwapsWidthAndHeightAndKeepsPointsOnTheirPixels) {
  const TrueFrame quarter = turned(small_frame(), 90.0);
  ASSERT_EQ(quarter.frame.camera.width, 3);
  ASSERT_EQ(quarter.frame.camera.height, 5);
  EXPECT_EQ(quarter.frame.depth(1, 4), 2000);  // right becomes down
  EXPECT_EQ(quarter.truth.person(1, 4), 0);
  EXPECT_TRUE(point_at(quarter.frame.camera, quarter.frame.depth, 1, 4).isApprox(quarter.truth.parts[0][0], 1e-5F));
  EXPECT_TRUE(quarter.truth.up->isApprox(Vector3f(1.F, 0.F, 0.F), 1e-5F));
  check(quarter.frame);
}

TEST(TurnedTruth, KeepsAllOfThePicture) {
  TrueFrame frame = small_frame();
  for (std::uint16_t& depth : frame.frame.depth) depth = 1000;
  frame.frame.depth(0, 0) = frame.frame.depth(4, 2) = 3000;
  const TrueFrame oblique = turned(frame, 30.0);
  EXPECT_GE(std::ranges::count(oblique.frame.depth, 3000), 2);
  EXPECT_EQ(std::ranges::count(oblique.frame.depth, 0) + std::ranges::count(oblique.frame.depth, 1000) +
                std::ranges::count(oblique.frame.depth, 3000),
            static_cast<long>(oblique.frame.depth.size()));
}

TEST(TurnedTruth, RefusesPixelsThatAreNotSquare) {
  TrueFrame frame = small_frame();
  frame.frame.camera.fy = 12.F;
  EXPECT_THROW(turned(frame, 30.0), Error);
}

}  // namespace
}  // namespace vesalius
