#include "vesalius/image.h"

#include <gtest/gtest.h>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

TEST(Crop, ReturnsThePixelsInTheBox) {
  Image<int> image(5, 4);
  for (int v = 0; v < 4; ++v) {
    for (int u = 0; u < 5; ++u) image(u, v) = 10 * v + u;
  }
  const Image<int> part = crop(image, {1, 2, 3, 2});
  ASSERT_EQ(part.width(), 3);
  ASSERT_EQ(part.height(), 2);
  EXPECT_EQ(part(0, 0), 21);
  EXPECT_EQ(part(2, 1), 33);
  EXPECT_TRUE(crop(image, {0, 0, 0, 0}).empty());
}

TEST(BoundingBox, IsTheSmallestAroundThePixelsInside) {
  const Box none = bounding_box(Mask(7, 5, 0));
  EXPECT_EQ(none.width, 0);
  EXPECT_EQ(none.height, 0);
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    Mask mask(7, 5, 0);
    int left = 7, right = -1, top = 5, bottom = -1;
    for (std::uint32_t i = 0; i <= random.below(4); ++i) {
      const auto u = static_cast<int>(random.below(7)), v = static_cast<int>(random.below(5));
      mask(u, v) = static_cast<std::uint8_t>(1 + random.below(255));
      left = std::min(left, u);
      right = std::max(right, u);
      top = std::min(top, v);
      bottom = std::max(bottom, v);
    }
    const Box box = bounding_box(mask);
    EXPECT_EQ(box.u, left);
    EXPECT_EQ(box.v, top);
    EXPECT_EQ(box.u + box.width - 1, right);
    EXPECT_EQ(box.v + box.height - 1, bottom);
  }
}

}  // namespace
}  // namespace vesalius
