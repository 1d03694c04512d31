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

TEST(FillRectangle, IsCutOffAtTheBorder) {
  ColourImage image(5, 4);
  fill_rectangle(image, {-2, 1, 4, 9}, {1, 2, 3});
  for (int v = 0; v < 4; ++v)
    for (int u = 0; u < 5; ++u) EXPECT_EQ(image(u, v), u < 2 && v >= 1 ? (Rgb{1, 2, 3}) : (Rgb{})) << u << " " << v;
  fill_rectangle(image, {9, 9, 2, 2}, {4, 5, 6});
  fill_rectangle(image, {-9, 0, 2, 2}, {4, 5, 6});
  EXPECT_FALSE(has(image, {4, 5, 6}));
}

/// Returns how much of a black picture is covered, in pixels, by white.
double covered(const ColourImage& image) {
  double sum = 0.0;
  for (const Rgb pixel : image) sum += pixel.g / 255.0;
  return sum;
}

TEST(Shapes, CoverTheirAreas) {
  const Rgb white{255, 255, 255};
  ColourImage image(100, 80);
  draw_disc(image, {40.3F, 35.8F}, 10.F, white);
  EXPECT_NEAR(covered(image), 3.1416 * 100.0, 3.0);
  image = ColourImage(100, 80);
  draw_ring(image, {40.3F, 35.8F}, 10.F, 2.F, white);
  EXPECT_NEAR(covered(image), 2.0 * 3.1416 * 10.0 * 2.0, 2.0);
  image = ColourImage(100, 80);
  draw_line(image, {20.F, 20.F}, {60.F, 50.F}, 4.F, white);
  EXPECT_NEAR(covered(image), 50.0 * 4.0 + 3.1416 * 4.0, 2.0);
}

TEST(Shapes, LieAboutMiddlesOfPixels) {
  ColourImage image(21, 21);
  draw_disc(image, {10.F, 10.F}, 4.F, {255, 100, 50});
  EXPECT_EQ(image(10, 10), (Rgb{255, 100, 50}));
  for (int v = 0; v < 21; ++v)
    for (int u = 0; u < 21; ++u) EXPECT_NEAR(image(u, v).r, image(20 - u, 20 - v).r, 2) << u << " " << v;
  ColourImage line(9, 9);
  draw_line(line, {-5.F, 4.F}, {20.F, 4.F}, 1.F, {255, 255, 255});
  for (int u = 0; u < 9; ++u) EXPECT_EQ(line(u, 4), (Rgb{255, 255, 255}));
  EXPECT_NEAR(covered(line), 9.0, 0.1);
}

TEST(Shapes, AreCutOffOutside) {
  ColourImage image(12, 8);
  draw_disc(image, {-900.F, 4.F}, 20.F, {255, 255, 255});
  draw_text(image, "far away", 3000, -50, {255, 255, 255});
  EXPECT_EQ(covered(image), 0.0);
  draw_line(image, {-3000.F, -3000.F}, {3000.F, 3000.F}, 3.F, {255, 255, 255});
  EXPECT_EQ(image(3, 3), (Rgb{255, 255, 255}));
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
