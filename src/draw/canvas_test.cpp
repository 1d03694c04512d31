#include "draw/canvas.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace vesalius {
namespace {

bool has(const ColourImage& image, Rgb colour) { return std::find(image.begin(), image.end(), colour) != image.end(); }

TEST(Enlarge, RepeatsEveryPixel) {
  Image<int> image(2, 1);
  image(0, 0) = 7;
  image(1, 0) = 9;
  const Image<int> twice = enlarge(image, 2);
  ASSERT_EQ(twice.width(), 4);
  ASSERT_EQ(twice.height(), 2);
  for (int v = 0; v < 2; ++v) {
    EXPECT_EQ(twice(0, v), 7);
    EXPECT_EQ(twice(1, v), 7);
    EXPECT_EQ(twice(2, v), 9);
    EXPECT_EQ(twice(3, v), 9);
  }
  EXPECT_EQ(enlarge(image, 1), image);
}

TEST(LegibleScale, DoublesOnlySmallPictures) {
  EXPECT_EQ(legible_scale(320), 2);
  EXPECT_EQ(legible_scale(479), 2);
  EXPECT_EQ(legible_scale(480), 1);
  EXPECT_EQ(legible_scale(1920), 1);
}

TEST(Mix, BlendsFromUnderToOver) {
  const Rgb under{0, 100, 200}, over{200, 100, 0};
  EXPECT_EQ(mix(under, over, 0.F), under);
  EXPECT_EQ(mix(under, over, 1.F), over);
  EXPECT_EQ(mix(under, over, 0.25F), (Rgb{50, 100, 150}));
}

TEST(View, KeepsChannelOrder) {
  ColourImage image(3, 2);
  view(image).at<cv::Vec3b>(1, 2) = {1, 2, 3};
  EXPECT_EQ(image(2, 1), (Rgb{1, 2, 3}));
}

TEST(DrawTag, StaysInsideThePicture) {
  const Rgb plate{255, 255, 0};
  for (const auto& [u, v] : {std::pair{-500, -500}, {500, 500}, {10, 30}}) {
    ColourImage image(120, 60);
    draw_tag(image, "0: 0.87", u, v, plate);
    // The plate is complete: its area minus the text has its colour.
    const auto plates = std::count(image.begin(), image.end(), plate);
    EXPECT_GT(plates, (text_width("0: 0.87") * kTextRow) / 2) << u << " " << v;
    EXPECT_TRUE(has(image, {0, 0, 0}));
  }
}

TEST(DrawTag, DrawsTextInContrastToThePlate) {
  ColourImage image(120, 60, {9, 9, 9});
  draw_tag(image, "IIIII", 10, 40, {0, 0, 60});
  const auto brightest = std::max_element(image.begin(), image.end(), [](Rgb a, Rgb b) { return a.g < b.g; });
  EXPECT_GT(brightest->g, 150);
}

TEST(DrawTag, WorksOnPicturesSmallerThanText) {
  ColourImage image(4, 3);
  draw_tag(image, "0: 0.87", 1, 1, {255, 0, 0});
  EXPECT_TRUE(has(image, {255, 0, 0}));
}

}  // namespace
}  // namespace vesalius
